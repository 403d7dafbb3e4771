#pragma once

#include <filesystem>

#include "mallow/mesh.h"

/// One reader per mesh format. Polygons are split into triangles that share their first corner. origin: where
/// given, becomes a point near the mesh that vertices are relative to, see read_mesh(). Throws IoError.
namespace mallow {

/// Wavefront OBJ: v and f; indices from 1, or negative from the last vertex on. Everything else is passed
/// over.
Mesh read_obj(const std::filesystem::path& file, Eigen::Vector3d* origin);
/// Elements vertex (x y z, and nx ny nz and material_id if there) and face (vertex_indices or vertex_index).
Mesh read_ply_mesh(const std::filesystem::path& file, Eigen::Vector3d* origin);
/// Binary or ascii STL; corners at the same place become one vertex, see welded().
Mesh read_stl(const std::filesystem::path& file, Eigen::Vector3d* origin);
/// Geomview OFF in text, also with colours, normals or texture coordinates, which are passed over.
Mesh read_off(const std::filesystem::path& file, Eigen::Vector3d* origin);

}  // namespace mallow

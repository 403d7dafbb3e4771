#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/export.h"
#include "mallow/mesh.h"
#include "mallow/vec3.h"

/// What mallow does with OpenVDB: target mallow::level_set. No OpenVDB type shows here; mallow/openvdb.h has
/// what gives OpenVDB's own grids.
namespace mallow {

class Surfacer;

/// Voxels along the longest side of a mesh that scenes and the command line sample.
inline constexpr int k_mesh_voxels = 192;

/// A closed mesh as an implicit shape: a narrow-band level set with `voxels` voxels along its longest side,
/// in [8, 2048]. Inside is where the mesh winds around a point more often outwards than inwards: a shell
/// within another that faces the other way is a cavity, one that faces the same way, or overlaps, is filled
/// with it. Triangles that face another way than their neighbours, and shells that are inside out, are
/// turned; the shape's notes say so. Where the triangles cannot agree on which side is outside, lines that
/// cross the mesh count: inside is behind an odd number of them. The shape's volume is the mesh's. Throws
/// ConfigError where the mesh is empty, open (why_not_closed) or has a vertex that is not finite.
MALLOW_EXPORT ImplicitShape mesh_shape(const Mesh& mesh, int voxels = k_mesh_voxels, int threads = 0);

/// A closed mesh as an obstacle, where the mesh lies: signed distances on a grid with `voxels` voxels along
/// its longest side, in [8, 512]; parts thinner than a voxel may be missed. Which side is inside is what
/// mesh_shape() says. Grids that are still in use are made once for equal meshes. Throws what mesh_shape()
/// does.
MALLOW_EXPORT DistanceField mesh_collider(const Mesh& mesh, int voxels = k_mesh_collider_voxels,
                                          bool inside = false, int threads = 0);

/// The level sets of the frame drawn last as the content of a VDB file, grids as level_set() in
/// mallow/openvdb.h gives them. materials: what materials are called, by MaterialId; grids whose material has
/// a name there say it in the metadata `material`.
MALLOW_EXPORT std::string level_set_vdb(const Surfacer& surfacer,
                                        std::span<const std::string> materials = {});

/// Points as the content of a VDB file: a PointDataGrid "particles" with the attributes v [m/s] (the name
/// that Houdini knows velocity by), group, which is the body, and id. positions: [m]; ids are their indices.
/// bodies: below 2^31. voxel_size: [m], > 0. Throws ConfigError where columns differ in length, a body is out
/// of range, or a position is not finite or further than 2^30 voxels from the origin.
MALLOW_EXPORT std::string points_vdb(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                     std::span<const std::uint32_t> bodies, float voxel_size,
                                     int threads = 0);

}  // namespace mallow

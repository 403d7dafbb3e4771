#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "mallow/body.h"
#include "mallow/mesh.h"
#include "mallow/surface_config.h"
#include "mallow/vec3.h"

/// What mallow does with OpenVDB: target mallow::level_set. No OpenVDB type shows here.
namespace mallow {

/// Voxels along the longest side of a mesh that scenes and the command line sample.
inline constexpr int k_mesh_voxels = 192;

/// A closed mesh as an implicit shape: a narrow-band level set with `voxels` voxels along its longest side.
/// Throws ConfigError where the mesh is empty, open (why_not_closed) or has a vertex that is not finite.
ImplicitShape mesh_shape(const Mesh& mesh, int voxels = k_mesh_voxels, int threads = 0);

/// A closed surface around particles: Zhu & Bridson 2005 on a narrow-band level set, then dual contouring.
/// positions: [m], finite. spacing: h of the sampled body [m], > 0. An empty span gives an empty mesh.
/// Throws ConfigError where a value is out of range or the grid would need more than 2^31 voxels in its band.
Mesh surface(std::span<const Vec3> positions, float spacing, const SurfaceConfig& config, int threads = 0);

/// Points as the content of a VDB file: a PointDataGrid "particles" with the attributes v [m/s] (the name
/// that Houdini knows velocity by), group and id. positions: [m]; ids are their indices. voxel_size: [m], >
/// 0. Throws ConfigError where columns differ in length, or a position is not finite or further than 2^30
/// voxels from the origin.
std::string points_vdb(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                       std::span<const std::uint8_t> groups, float voxel_size, int threads = 0);

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "mallow/body.h"
#include "mallow/executor.h"
#include "mallow/export.h"
#include "mallow/mesh.h"
#include "mallow/surface_config.h"
#include "mallow/vec3.h"

/// What mallow does with OpenVDB: target mallow::level_set. No OpenVDB type shows here.
namespace mallow {

/// Voxels along the longest side of a mesh that scenes and the command line sample.
inline constexpr int k_mesh_voxels = 192;

/// A closed mesh as an implicit shape: a narrow-band level set with `voxels` voxels along its longest side.
/// Inside is where the mesh winds around a point more often outwards than inwards: a shell within another
/// that faces the other way is a cavity, one that faces the same way, or overlaps, is filled with it.
/// Triangles that face another way than their neighbours, and shells that are inside out, are turned; the
/// shape's notes say so. Where the triangles cannot agree on which side is outside, lines that cross the mesh
/// count: inside is behind an odd number of them. The shape's volume is the mesh's. Throws ConfigError where
/// the mesh is empty, open (why_not_closed) or has a vertex that is not finite.
MALLOW_EXPORT ImplicitShape mesh_shape(const Mesh& mesh, int voxels = k_mesh_voxels, int threads = 0);

/// Particles that surfaces are drawn around.
struct SurfaceParticles {
  std::span<const Vec3> positions;        ///< [m], finite
  std::span<const Vec3> velocities = {};  ///< [m/s]; empty, or one each: then vertices have velocities too
  std::span<const std::uint8_t> groups = {};  ///< group of each; empty: all in group 0
  std::span<const float> spacings;            ///< h of each group [m], > 0
};

/// Draws the surfaces of one frame after another, and keeps its memory from frame to frame. A mesh is closed,
/// manifold and oriented; its vertices have normals and, where particles have them, velocities and material
/// ids, which are groups. Same particles, same bits, for any number of threads.
class MALLOW_EXPORT Surfacer {
 public:
  /// threads, executor: as in SolverConfig. Throws ConfigError where a value is out of range.
  explicit Surfacer(const SurfaceConfig& config, int threads = 0,
                    std::shared_ptr<Executor> executor = nullptr);
  ~Surfacer();
  /// Moves, with its memory.
  Surfacer(Surfacer&&) noexcept;
  /// @copydoc Surfacer(Surfacer&&)
  Surfacer& operator=(Surfacer&&) noexcept;

  /// The surfaces of all groups as one mesh, which holds until the next call; no particles, no mesh. Throws
  /// ConfigError where particles are not as said, or the surface would take more than
  /// SurfaceConfig::memory_limit.
  const Mesh& draw(const SurfaceParticles& particles);
  /// The level sets of the frame drawn last as the content of a VDB file: grids "surface", or "surface_0" and
  /// on where groups have surfaces of their own; signed distances [m], negative inside.
  std::string level_set_vdb() const;
  /// Memory it holds [bytes].
  std::size_t bytes() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// The surface around the particles of one body, h = spacing [m]: a Surfacer that draws once.
MALLOW_EXPORT Mesh surface(std::span<const Vec3> positions, float spacing, const SurfaceConfig& config,
                           int threads = 0);

/// Points as the content of a VDB file: a PointDataGrid "particles" with the attributes v [m/s] (the name
/// that Houdini knows velocity by), group and id. positions: [m]; ids are their indices. voxel_size: [m], >
/// 0. Throws ConfigError where columns differ in length, or a position is not finite or further than 2^30
/// voxels from the origin.
MALLOW_EXPORT std::string points_vdb(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                     std::span<const std::uint8_t> groups, float voxel_size, int threads = 0);

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/executor.h"
#include "mallow/export.h"
#include "mallow/ids.h"
#include "mallow/mesh.h"
#include "mallow/simulation.h"
#include "mallow/surface_config.h"
#include "mallow/vec3.h"

/// Surfaces around particles: target mallow::surface, which needs the engine alone.
namespace mallow {

/// Vectors of particles, seen where they lie: the columns of a simulation, or an array. Vector i is of row i.
class StridedVectors {
 public:
  StridedVectors() = default;  ///< none
  // NOLINTBEGIN(google-explicit-constructor): a view of the same values
  /// Of columns.
  StridedVectors(const VectorView& columns)
      : x_(columns.x().data()),
        y_(columns.y().data()),
        z_(columns.z().data()),
        size_(columns.size()),
        stride_(1) {}
  /// Of an array.
  StridedVectors(std::span<const Vec3> array) : size_(array.size()), stride_(3) {
    if (array.empty()) return;
    x_ = array.front().data();
    y_ = x_ + 1;
    z_ = x_ + 2;
  }
  /// Of an array.
  StridedVectors(const std::vector<Vec3>& array) : StridedVectors(std::span(array)) {}
  // NOLINTEND(google-explicit-constructor)

  std::size_t size() const { return size_; }  ///< rows
  bool empty() const { return size_ == 0; }   ///< no rows
  /// The vector of a row, a copy.
  Vec3 operator[](std::size_t row) const {
    const std::size_t at = stride_ * row;
    return {x_[at], y_[at], z_[at]};
  }

 private:
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  const float* x_ = nullptr;
  const float* y_ = nullptr;
  const float* z_ = nullptr;
  std::size_t size_ = 0;
  std::size_t stride_ = 0;  ///< floats from a row to the next
};

/// Particles that a surface is drawn around.
struct SurfaceBody {
  float spacing;  ///< h [m], > 0
  /// The body that they are part of. Particles of one body have one surface, whose material id it is. Memory
  /// is taken for each body up to the largest.
  std::uint32_t body = 0;
  std::optional<Simulation::Rows> rows = {};  ///< its particles; left out: all
  std::string_view name = {};                 ///< of the body, which SurfacePart has too
  MaterialId material = {};                   ///< the same
};

/// Particles that surfaces are drawn around, seen where they lie.
struct SurfaceParticles {
  StridedVectors positions;         ///< [m], finite
  StridedVectors velocities = {};   ///< [m/s], finite; none, or one each: then vertices have velocities too
  std::vector<SurfaceBody> bodies;  ///< no row is in two of them; those in none are not drawn
  /// Slots distinct, below 2^28. Sums over particles are taken in the order of slots, so that a mesh has the
  /// same bits whatever the order of rows is. None: in the order of rows.
  std::span<const ParticleId> ids = {};
};

/// The particles of a simulation as they are now; a view, valid until the next step or change.
MALLOW_EXPORT SurfaceParticles surface_particles(const Simulation& simulation);

/// The part of a mesh that is the surface of one body: a range of vertices and one of triangles, which have
/// no other vertices.
struct SurfacePart {
  std::uint32_t body;   ///< as in SurfaceBody, and in Mesh::material_ids of these vertices
  std::string name;     ///< of the first SurfaceBody that is part of the body
  MaterialId material;  ///< the same
  std::size_t first_vertex, vertices;
  std::size_t first_triangle, triangles;
};

/// Draws the surfaces of one frame after another, and keeps its memory from frame to frame. A mesh is closed,
/// manifold and oriented; its vertices have normals, material ids, which are bodies, and, where particles
/// have them, velocities. Same particles, same bits, for any number of threads. Surfaces whose particles are
/// bit by bit those of the frame before, as of bodies that sleep, are not drawn again but kept. Of bodies
/// whose surfaces are joined nothing is kept once a particle of any moves, and nothing of all where voxels
/// are a count (SurfaceConfig::voxels) and the box changes.
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

  /// The surfaces of all bodies as one mesh, which holds until the next call; no particles, no mesh. Throws
  /// ConfigError where particles are not as said, or the surface would take more than
  /// SurfaceConfig::memory_limit.
  const Mesh& draw(const SurfaceParticles& particles);
  /// The parts of the mesh drawn last, one for each body with particles, in the order of bodies: they follow
  /// each other and are all of the mesh. None where surfaces are joined: there Mesh::material_ids tell bodies
  /// apart.
  std::span<const SurfacePart> parts() const;
  /// How many surfaces the frame drawn last has: one, or one for each body up to the last that has
  /// particles.
  std::size_t surface_count() const;
  /// Memory it holds [bytes].
  std::size_t bytes() const;

 private:
  friend struct SurfacerAccess;  // internal
  struct Work;
  std::unique_ptr<Work> work_;
};

/// The surface around the particles of one body, h = spacing [m]: a Surfacer that draws once.
MALLOW_EXPORT Mesh surface(StridedVectors positions, float spacing, const SurfaceConfig& config,
                           int threads = 0);

}  // namespace mallow

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "mallow/executor.h"
#include "mallow/export.h"
#include "mallow/mesh.h"
#include "mallow/simulation.h"

/// Meshes that follow a body: target mallow::surface, which needs the engine alone.
namespace mallow {

/// A mesh of your own that follows a body which keeps together: it keeps its vertices, and with them its
/// texture coordinates, and no surface has to be drawn around particles. A vertex at v̄ in the reference shape
/// is carried by the 8 particles nearest to it, as linear blend skinning has bones [Magnenat-Thalmann et al.
/// 1988]:
///
///   x = Σ_i w_i (R_i (v̄ − x̄_i) + x_i),   n = Σ_i w_i R_i n̄, scaled to length 1
///
/// with the rotation R_i of Simulation::rotation(), x̄_i of rest_position() and weights w_i that fall smoothly
/// to 0 at the ninth particle, or three spacings away, and sum to 1. Rotations are those that the last step
/// matched shapes by, where it began: a body that turns by an angle a step turns its skin by that much late.
///
/// A body that yields has another reference shape from then on. The next update() takes v̄ and n̄ there: v̄' = Σ
/// w_i (A_i (v̄ − x̄_i) + x̄'_i), where A_i turns the old region around particle i into the new one [TK eq. 7].
/// That is where the old shape would have taken the vertex, so nothing jumps, and it does not depend on how
/// often update() was called before. Weights stay. Same particles, same bits, for any number of threads and
/// in whatever order the rows are.
class MALLOW_EXPORT Skin {
 public:
  /// Binds a mesh to a body where the body is now: before the first step, where it was added. Calls
  /// prepare(). mesh: open or closed, at least one vertex, finite. Normals are made where it has none, from
  /// the triangles that meet at a place; velocities are dropped, and material_ids become the body. threads,
  /// executor: as in SolverConfig. Throws ConfigError where there is no such body, it has alpha 1 and so no
  /// regions, a vertex is not within three spacings of its particles, or the mesh is not as said.
  Skin(Simulation& simulation, BodyId body, Mesh mesh, int threads = 0,
       std::shared_ptr<Executor> executor = nullptr);
  ~Skin();
  /// Moves, with its memory.
  Skin(Skin&&) noexcept;
  /// @copydoc Skin(Skin&&)
  Skin& operator=(Skin&&) noexcept;

  /// The mesh where the body is now, which holds until the next call. Allocates nothing, but where the body
  /// has yielded since the last call for the first time. Throws ConfigError, and changes nothing, where the
  /// simulation is another one, the body has no regions any more or has become part of another
  /// (Body::merges), or a particle that it follows is gone.
  const Mesh& update(const Simulation& simulation);
  /// As the last update() left it; before the first as it was bound.
  const Mesh& mesh() const;
  /// The body that it follows.
  BodyId body() const;

  /// The same mesh with velocities, those of the particles by the same weights [m/s]. They hold until the
  /// next update(). Throws as that does.
  const Mesh& find_velocities(const Simulation& simulation);

  /// How far the body was torn at each vertex [spacings], >= 0, at the last update(): the most by which the
  /// distance of the particle nearest to the vertex from another that carries it has grown since the skin was
  /// bound. Jelly that falls 20 spacings has 0.3 in the middle, and 1.1 for a moment where most is pulled;
  /// what stays above 1 is a gap that the skin bridges. Holds until the next call.
  std::span<const float> stretch();

  /// All that it is, for a chunk beside those of Simulation::save().
  std::string save() const;
  /// A skin that goes on where a saved one stood, with the same bits; its mesh is in the rest pose until the
  /// next update(). Throws ConfigError where the bytes are not what save() gave.
  static Skin restore(const std::string& saved, int threads = 0,
                      std::shared_ptr<Executor> executor = nullptr);
  /// Memory it holds [bytes].
  std::size_t bytes() const;

 private:
  Skin();
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace mallow

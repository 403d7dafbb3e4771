#pragma once

#include <optional>

#include "mallow/files.h"
#include "mallow/scene.h"

namespace mallow::program {

/// What the camera has to have in view through a film: what particles reach in its frames, but for the few
/// that fly off alone, the ground near below, and the visible colliders near by, where their keyframes take
/// them too.
class FilmBounds {
 public:
  FilmBounds() = default;
  explicit FilmBounds(const ParticleFrame& only) { add(only); }
  void add(const ParticleFrame& frame);
  /// spacing: of particles, at least [m]. Something around 0 where no frame had any particles.
  Aabb box(const Scene& scene, float spacing) const;

 private:
  std::optional<Aabb> box_;
  double last_time_ = 0;  ///< [s]
};

/// What a picture of a simulation as it is now has to have in view, with the ground below it: what is in the
/// air comes down.
Aabb bounds_now(const Scene& scene, Simulation& simulation);

/// The colliders of a scene that are seen.
std::vector<Collider> visible_colliders(const Scene& scene);

}  // namespace mallow::program

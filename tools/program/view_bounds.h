#pragma once

#include <optional>

#include "mallow/files.h"
#include "mallow/scene.h"

namespace mallow::program {

/// What the camera has to have in view through a whole film, as far as frame 0 and the scene tell: the
/// particles of frame 0, the ground below them, how bodies that are thrown fly, what emitters reach and heap
/// up, and the visible colliders near by, where their keyframes take them too. The same for any number of
/// frames, so that a film that is made longer keeps its camera.
Aabb view_bounds(const Scene& scene, const ParticleFrame& first);

/// The same of a film whose frames are there: what its particles reach in all of them, but for the few that
/// fly off alone, and the visible colliders near by.
class FilmBounds {
 public:
  void add(const ParticleFrame& frame);
  /// spacing: of particles, at least [m]. Nothing where no frame had any.
  std::optional<Aabb> box(const Scene& scene, float spacing) const;

 private:
  std::optional<Aabb> box_;
  double last_time_ = 0;  ///< [s]
};

/// The colliders of a scene that are seen.
std::vector<Collider> visible_colliders(const Scene& scene);

}  // namespace mallow::program

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mallow/files.h"
#include "mallow/scene.h"

namespace mallow::program {

/// What the camera has to have in view through a film: all particles as they begin, what particles reach
/// later but for drops that fly off, the ground near below, and the visible colliders near by, where their
/// keyframes take them too: whole, but for those that are many times as large as what moves. A splash is seen
/// as far as most of it holds together: pieces of less than a twentieth of their body leave the picture, as
/// all do once they are what most of the frame is.
class FilmBounds {
 public:
  /// spacings: of the particles of each body [m]; a body without one does not come apart.
  explicit FilmBounds(std::span<const float> spacings) : spacings_(spacings.begin(), spacings.end()) {}
  FilmBounds(std::span<const float> spacings, const ParticleFrame& only) : FilmBounds(spacings) { add(only); }
  void add(const ParticleFrame& frame);
  /// What a frame each reaches, and what is seen beside it: together smaller than one box around all of it.
  /// Something around 0 where no frame had any particles.
  std::vector<Aabb> boxes(const Scene& scene) const;
  /// One around them.
  Aabb box(const Scene& scene) const;

 private:
  /// What frames reach, and the most particles that one of them has.
  struct Reach {
    std::vector<Aabb> boxes = {};
    std::size_t particles = 0;
    void add(const Aabb& frame, std::size_t count);
  };
  const std::vector<Aabb>& reached() const;

  std::vector<float> spacings_;
  Reach whole_;           ///< of frames that hold together, without drops
  Reach all_;             ///< of all frames
  double last_time_ = 0;  ///< [s]
};

/// What a picture of a simulation as it is now has to have in view, with the ground below it: what is in the
/// air comes down.
Aabb bounds_now(const Scene& scene, Simulation& simulation);

/// The colliders of a scene that are seen.
std::vector<Collider> visible_colliders(const Scene& scene);

}  // namespace mallow::program

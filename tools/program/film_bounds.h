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
/// all do once they are what most of the frame is. What a nozzle still holds has not come into the film yet:
/// it counts only where nothing else is ever seen.
class FilmBounds {
 public:
  /// spacings: of the particles of each body [m]; a body without one does not come apart. emitters: of the
  /// scene, where there are any.
  explicit FilmBounds(std::span<const float> spacings, std::span<const SceneEmitter> emitters = {})
      : spacings_(spacings.begin(), spacings.end()), emitters_(emitters.begin(), emitters.end()) {}
  FilmBounds(std::span<const float> spacings, const ParticleFrame& only,
             std::span<const SceneEmitter> emitters = {})
      : FilmBounds(spacings, emitters) {
    add(only);
  }
  void add(const ParticleFrame& frame) { add(frame, spacings_); }
  /// The same of a frame in which the bodies have these spacings.
  void add(const ParticleFrame& frame, std::span<const float> spacings);
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
  void add_seen(const ParticleFrame& frame, std::span<const float> spacings);

  std::vector<float> spacings_;
  std::vector<SceneEmitter> emitters_;
  std::vector<Aabb> held_;  ///< what frames reach in which nozzles hold all
  Reach whole_;             ///< of frames that hold together, without drops
  Reach all_;               ///< of all frames
  double last_time_ = 0;    ///< [s]
};

/// What a picture of a simulation as it is now has to have in view, with the ground below it: what is in the
/// air comes down.
Aabb bounds_now(const Scene& scene, Simulation& simulation);

/// The colliders of a scene that are seen.
std::vector<Collider> visible_colliders(const Scene& scene);

}  // namespace mallow::program

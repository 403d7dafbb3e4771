#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/schedule.h"
#include "mallow/vec3.h"

namespace mallow {

/// A nozzle that a strand leaves: layers of particles, a spacing apart, move out of its plane as one with it
/// until they have passed it, and are free from then on. A strand is one body; what is elastic keeps its
/// shape from layer to layer. [model 2, section 6]
struct Emitter {
  /// Of a layer, around the origin of the pose, across its z axis: give the radius of a disc, or the width
  /// and height of a rectangle, each > 0 [m], or points.
  std::optional<float> radius = {};
  std::optional<float> width = {};   ///< along x of the pose, > 0
  std::optional<float> height = {};  ///< along y of the pose, > 0
  /// In the frame of the pose, its z left out; finite, a tenth of the spacing apart at least [m].
  std::vector<Vec3> points = {};
  float spacing = 1.0f;  ///< h [m], > 0
  /// Where the nozzle is: the strand leaves it along its z axis. It is in the way of nothing; a collider may
  /// be put around it, which layers pass until they are free.
  Pose pose = {};
  Vec3 velocity{0, 0, 0};  ///< of the nozzle [m/s]
  /// Where given, it moves and turns through these poses, and what it holds with it, as a Collider does. Its
  /// pose and velocity are those that follow.
  std::vector<PoseKeyframe> keyframes = {};
  /// Of the strand, from the nozzle on [m/s], >= 0; 0: it does not flow. No faster than a step carries: see
  /// Simulation::set_velocity().
  Schedule speed = 1.0f;
  std::optional<double> start = {};  ///< it flows from this time on [s], >= 0; left out: at once
  /// And until this [s], >= 0, when what has not passed the nozzle is taken away; left out: it goes on.
  std::optional<double> stop = {};
  /// Random displacement of every point across the flow, at most jitter h per axis, in [0, 0.45]. Layers of a
  /// disc are turned besides, each by 2.4 rad: a strand of straight rows does not buckle.
  float jitter = k_default_jitter;
  /// Its strand is not made longer while it has so many particles, in [1, 100000000]; those of bodies that
  /// have become one with it count.
  int most_particles = 1'000'000;
  bool merges = false;  ///< Body::merges of its strand
};

}  // namespace mallow

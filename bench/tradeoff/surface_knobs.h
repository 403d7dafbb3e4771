#pragma once

#include "harness/results.h"
#include "tradeoff/trajectory.h"

namespace mallow::bench {

/// Surfaces of two moments of a motion, the middle and the end, at every setting of the surface's knobs: a
/// row each with the time they take [ms] and how far they are from the finest one [h].
std::vector<Json> measure_surfaces(const std::string& scene_name, const Scene& scene,
                                   const Trajectory& motion, int repeats, bool small, int threads);

}  // namespace mallow::bench

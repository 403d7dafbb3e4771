#pragma once

#include <functional>

#include "figures/figure.h"
#include "harness/results.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow::bench {

/// A take that has been run.
struct Run {
  Recording recording;
  Curve times;  ///< of the frames [s]
  Json about;   ///< scene, settings, particles, steps, reference updates, state hash, wall time
};

/// Sees every frame of a take, frame 0 first; what it throws ends the run.
using FrameVisitor = std::function<void(const Scene& scene, const SimulationInfo& info, int number,
                                        const ParticleFrame& frame)>;

/// Runs a take and measures what the figure asks for, at the start and after every step, which counts as a
/// frame here however long it is.
Run record(const Figure& figure, const Take& take, int threads, const FrameVisitor& visit);

}  // namespace mallow::bench

#pragma once

#include <cstdint>
#include <optional>

#include "mallow/cache.h"
#include "mallow/files.h"
#include "mallow/run_report.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow::cli {

/// How far to run and what to write of every frame.
struct RunPlan {
  int frames = 0;                     ///< frames after frame 0
  std::optional<std::int64_t> steps;  ///< where given: this many steps, however many frames that makes
  bool surface = true;
  bool images = true;
  int threads = 1;
};

/// Runs a scene to its end and writes its frames into `cache`, where there is one. `report` is kept up to
/// date: it is right also when this throws.
void run_frames(const Scene& scene, Simulation& simulation, const RunPlan& plan, const Cache* cache,
                RunReport& report);

}  // namespace mallow::cli

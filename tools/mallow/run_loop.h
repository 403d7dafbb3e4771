#pragma once

#include "mallow/cache.h"
#include "mallow/run_plan.h"
#include "mallow/run_report.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow::cli {

/// Runs a scene to its end, from where `simulation` and `report` are, and writes its frames and checkpoints
/// into `cache`, where there is one. `report` is kept up to date: it is right also when this throws. Throws
/// RunFailure where the run is interrupted; with a cache it can be resumed then.
void run_frames(const Scene& scene, Simulation& simulation, const RunPlan& plan, const Cache* cache,
                RunReport& report);

}  // namespace mallow::cli

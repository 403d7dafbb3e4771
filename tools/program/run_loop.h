#pragma once

#include <functional>
#include <span>

#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/skin.h"
#include "program/cache.h"
#include "program/run_plan.h"
#include "program/run_report.h"
#include "program/series.h"

namespace mallow::program {

/// How a caller follows a run and ends it early. All are called between steps by the thread that runs, and
/// may be empty.
struct RunCallbacks {
  std::function<void(const RunReport& report)> after_step;
  std::function<void(const RunReport& report)> after_frame;  ///< frame report.frames, handed to the writer
  std::function<bool()> stop;                                ///< asked before every step
};

enum class RunEnd { complete, stopped };

/// Runs a scene to its end, from where `simulation`, its skins and `report` are, and writes its frames and
/// checkpoints into `cache`, where there is one (else null), and a row of `series` for each frame. `report`
/// is kept up to date: it is right also when this throws. A run that is stopped ends with a checkpoint, from
/// which it can be resumed; one that is complete too, or that a step, a surface or a picture ends, where the
/// plan asks for any. Throws RunFailure where that cannot be written, and what steps and files throw.
RunEnd run_frames(const Scene& scene, Simulation& simulation, std::span<Skin> skins, const RunPlan& plan,
                  const Cache* cache, RunReport& report, const RunCallbacks& callbacks = {},
                  Series* series = nullptr);

/// What to say where a run that goes on has already taken all that it is asked for; else empty.
std::string nothing_left(const RunPlan& plan, const RunReport& report);

}  // namespace mallow::program

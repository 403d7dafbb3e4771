#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/saved_state.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/skin.h"
#include "program/cache.h"
#include "program/run_plan.h"
#include "program/run_report.h"
#include "program/series.h"

namespace mallow::program {

/// What the checkpoints of a run hold beside its simulation, and when they are due.
class Checkpoints {
 public:
  Checkpoints(const Scene& scene, const RunPlan& plan, const Cache& cache);

  /// By any count.
  bool are_wanted() const { return interval_.frames > 0 || interval_.seconds > 0; }
  bool due_after_step() const;
  bool due_after_frame(int frame) const;
  /// series: null where the run writes none.
  SavedState take(const Simulation& simulation, std::span<const Skin> skins, const RunReport& report,
                  const Series* series);

 private:
  using Clock = std::chrono::steady_clock;

  CheckpointInterval interval_;
  std::string scene_;
  std::string plan_;
  Clock::time_point taken_ = Clock::now();
};

/// A run as a checkpoint holds it.
struct CheckpointedRun {
  Scene scene;   ///< as the run began with it
  RunPlan plan;  ///< without frames and threads, which it does not keep
  RunReport report;
  Simulation simulation;
  std::vector<Skin> skins;
  std::string series;          ///< Series::saved(); empty where the run writes none
  std::filesystem::path file;  ///< the checkpoint
  std::string passed_over;     ///< why it is not the newest one; empty where it is
};

/// The run of the newest checkpoint that is whole. A newer one that is damaged is removed, lest it take the
/// place of the whole one. Throws IoError that says what is wrong with all there are, and what can be done.
CheckpointedRun load_newest_checkpoint(const Cache& cache, int threads);

/// How far the newest checkpoint that is whole came. None where there is no such one.
struct CheckpointPlace {
  int frame = 0;
  std::int64_t step = 0;
};
std::optional<CheckpointPlace> place_of_checkpoint(const Cache& cache);

}  // namespace mallow::program

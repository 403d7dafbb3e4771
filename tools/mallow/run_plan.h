#pragma once

#include <cstdint>
#include <optional>

namespace mallow::cli {

/// When checkpoints are due, by either count.
struct CheckpointInterval {
  int frames = 0;  ///< 0: not by frames
  /// Of wall time [s]; 0: not by time. The default costs a run less than 1% at a million particles, and most
  /// of that beside the steps.
  double seconds = 60;
};

/// How far to run and what to write of every frame.
struct RunPlan {
  int frames = 0;                     ///< frames after frame 0
  std::optional<std::int64_t> steps;  ///< where given: this many steps, however many frames that makes
  bool surface = true;
  bool images = true;
  int threads = 1;
  CheckpointInterval checkpoints;
};

}  // namespace mallow::cli

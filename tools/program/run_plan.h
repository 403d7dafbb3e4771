#pragma once

#include <cstdint>
#include <optional>

namespace mallow::program {

/// When checkpoints are due, by either count.
struct CheckpointInterval {
  int frames = 0;  ///< 0: not by frames
  /// Of wall time [s]; 0: not by time. With a million particles the steps wait 30 ms for a checkpoint, while
  /// 50 MB are written in about a second beside them: far below 1% of the default.
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

}  // namespace mallow::program

#pragma once

#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// Runs settings of one scene, all in the same way.
class Runner {
 public:
  /// options: to outlive this.
  Runner(const StudyOptions& options, int frames, double frame_time);

  /// deadline: wall_clock() at which it ends as it is; drawn: its surface is drawn, and timed, at each
  /// moment; last_bit: one particle of each body is moved by its last bits. Throws Stopped.
  Motion run(const Scene& scene, double deadline, bool drawn, bool last_bit = false);

  MotionPlan& plan() { return plan_; }
  int threads() const { return threads_; }

 private:
  const StudyOptions& options_;
  int threads_;
  MotionPlan plan_;
};

/// Of a clock that never goes back [s].
double wall_clock();

}  // namespace mallow::tradeoff

#pragma once

#include <limits>
#include <set>

#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// Moves one particle of each body by its last bits: as soon as the body has one that no nozzle holds.
class LastBit {
 public:
  void move(Simulation& simulation);
  /// When the first was moved [s].
  std::optional<double> begin() const { return begin_; }

 private:
  std::set<BodyId> moved_;
  std::optional<double> begin_;
};

/// How far the surfaces of a run are from finer ones of the same particles.
struct SurfaceCheck {
  SurfaceConfig fine;                ///< how those are drawn
  std::optional<double> error = {};  ///< root mean square over what is looked at [h]; nothing where the fine
                                     ///< ones cannot be drawn
};

/// How a setting is run.
struct RunHow {
  double deadline = std::numeric_limits<double>::infinity();  ///< wall_clock() at which it ends as it is
  double running = std::numeric_limits<double>::infinity();   ///< wall time of the same once it is built [s]
  bool drawn = false;               ///< its surface is drawn, and timed, at some moments
  LastBit* last_bit = nullptr;      ///< where it is to be moved
  SurfaceCheck* surface = nullptr;  ///< where it is to be looked at
  /// Called with the surface of each moment; empty: fewer are drawn.
  std::function<void(const Simulation& simulation, const Mesh& surface)> show = {};
};

/// Runs settings of one scene, all in the same way.
class Runner {
 public:
  /// options: to outlive this.
  Runner(const StudyOptions& options, int frames, double frame_time);

  /// Throws Stopped.
  Motion run(const Scene& scene, const RunHow& how);

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

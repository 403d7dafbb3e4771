#pragma once

#include <vector>

#include "harness/results.h"
#include "tradeoff/knobs.h"
#include "tradeoff/trajectory.h"

namespace mallow::bench {

struct TradeoffSettings {
  int repeats = 3;            ///< timed runs of every setting, round by round
  int reference_factor = 16;  ///< the reference's steps are this much shorter than the scene's
  double duration = 18;       ///< [s]
  bool small = false;         ///< fewer particles and settings: for tests
};
Json to_json(const TradeoffSettings& settings);

/// What every setting of a scene is held against: the textbook implementation in double at a fine step.
struct Reference {
  Trajectory motion;
  /// The same at coarser steps against it: how far it has converged. A row each.
  std::vector<Json> convergence;
};
Reference make_reference(const Scene& scene, const TradeoffSettings& settings, int threads);

/// A row for every setting of a scene: time and errors, and whether it is on the front. checkpoint is called
/// between runs and may throw.
std::vector<Json> measure_motion(const std::string& scene_name, const std::filesystem::path& file,
                                 const std::vector<Setting>& all, const Reference& reference,
                                 const TradeoffSettings& settings, int threads,
                                 const std::function<void()>& checkpoint);

/// Moments of a trajectory are so many of the scene's own steps apart.
double moment_interval(const Scene& scene);
std::size_t moment_count(const Scene& scene, const TradeoffSettings& settings);

}  // namespace mallow::bench

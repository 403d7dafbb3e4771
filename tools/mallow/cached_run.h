#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "mallow/cache.h"
#include "mallow/run_report.h"
#include "mallow/scene.h"

namespace mallow::cli {

/// What the commands that work from a cache have in common.
struct CachedRunOptions {
  std::string folder;
  std::vector<std::string> overrides;
  int threads = 0;
};

/// An earlier run, read back.
struct CachedRun {
  Cache cache;
  Scene scene;
  nlohmann::ordered_json report;
  std::vector<float> spacings;  ///< h of each group [m]
  int threads;
};

/// Throws IoError and ConfigError. `section`: the one whose keys may be changed, as the motion is there
/// already, with "render" also which colliders are visible; empty: none, and the run stays as it is. No other
/// program writes into the folder while the run lives.
CachedRun open_cached_run(const CachedRunOptions& options, const std::string& section);

/// Calls `work` for every frame, with progress and an end at Ctrl-C. Returns how many frames that were.
std::size_t for_each_frame(const std::vector<int>& frames, const char* verb,
                           const std::function<void(int frame)>& work);

/// Writes the scene as it was changed, the new times of `stages` and the summary.
void close_cached_run(CachedRun& run, const StageTimes& seconds, std::span<const Stage> stages);

}  // namespace mallow::cli

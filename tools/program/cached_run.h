#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "mallow/scene.h"
#include "program/cache.h"
#include "program/run_report.h"

namespace mallow::program {

/// Which earlier run is read, and what of its scene is changed.
struct CachedRunOptions {
  std::string folder;
  std::vector<std::string> overrides;  ///< "section.key=value"
  int threads = 0;                     ///< 0: one for each processor
  bool looks = false;                  ///< also while somebody writes, see Cache::Access::look
  bool shared = false;                 ///< others may write into the folder too, see SharedFrames
};

/// An earlier run, read back.
struct CachedRun {
  Cache cache;
  Scene scene;
  nlohmann::ordered_json report;
  std::vector<SlotBody> bodies;  ///< by slot, as the run ended
  std::vector<PastBody> past;    ///< those that had these slots before
  int threads;

  /// By slot, as they were in a frame.
  std::vector<SlotBody> bodies_at(int frame) const;
};

/// Throws IoError and ConfigError. `section`: the one whose keys may be changed, as the motion is there
/// already, with "render" also which colliders are visible; empty: none, and the run stays as it is.
/// Overrides count on top of the section as it was in the run, not as an earlier call left it. No other
/// program writes into the folder while the run lives, but for those with which it is shared.
CachedRun open_cached_run(const CachedRunOptions& options, const std::string& section);

/// Writes the scene as it was changed, and the report with the new times of `stages`.
void close_cached_run(CachedRun& run, const StageTimes& seconds, std::span<const Stage> stages);

}  // namespace mallow::program

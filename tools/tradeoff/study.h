#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mallow/scene_tuning.h"
#include "program/scene_changes.h"
#include "render/renderer.h"

namespace mallow::tradeoff {

struct StudyOptions {
  SceneKnobOptions knobs;
  std::vector<std::string> measures = {};  ///< see make_measures()
  double budget = 60;                      ///< wall time of measuring [s]
  int repeats = 3;
  int combinations = 16;
  std::optional<int> frames = {};  ///< of the scene's, from the first on
  std::function<bool()> stop = {};
  std::function<void(const std::string&)> progress = {};
};

/// A scene that was measured.
struct Study {
  SceneKnobs knobs;
  TuningConfig config;
  TuningResult result;
  Aabb view;  ///< what the camera has to have in view
  int threads;
};

/// Throws ConfigError and what the scene throws as it is.
Study run_study(const Scene& scene, const StudyOptions& options);

/// What a choice changes in the scene.
std::vector<program::SceneChange> changes_of(const Study& study, const TuningChoice& choice);
/// The same as lines to paste into the scene (TOML).
std::string lines_to_paste(const Study& study, const TuningChoice& choice);

/// "60s", "5m", "1.5h", "250ms"; a bare number is seconds. Throws ConfigError that names `field`.
double parse_duration(const std::string& text, const std::string& field);

/// What is said of a motion in a sentence each: frames, threads, convergence, chaos, what was left out.
std::vector<std::string> findings(const Study& study);

}  // namespace mallow::tradeoff

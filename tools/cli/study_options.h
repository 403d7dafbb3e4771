#pragma once

#include <string>
#include <vector>

#include "cli/scene_options.h"
#include "program/input_files.h"
#include "tradeoff/study.h"

namespace mallow::cli {

/// What `tradeoff` and `tune` share.
struct StudyArguments {
  SceneOptions scene;
  std::string budget = "60s";
  std::vector<std::string> knobs, measures;
  int repeats = 9;
  int threads = 0;
  bool no_surface = false;
};
void add_study_options(CLI::App& command, StudyArguments& arguments);
/// Throws ConfigError where --budget and the like are wrong.
tradeoff::StudyOptions study_options(const StudyArguments& arguments, const Scene& scene);
/// "60s", "5m", "16ms" or "60" in seconds. Throws ConfigError that names `option`.
double seconds_of(const std::string& text, const std::string& option);
/// "0.1h" or "0.1". Throws ConfigError that names `option`.
double spacings_of(const std::string& text, const std::string& option);

}  // namespace mallow::cli

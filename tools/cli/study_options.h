#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/scene_options.h"
#include "program/input_files.h"
#include "tradeoff/study.h"
#include "tradeoff/tables.h"

namespace mallow::cli {

/// What `tradeoff` and `tune` share.
struct StudyArguments {
  SceneOptions scene;
  std::string budget = "60s";
  std::vector<std::string> knobs, measures;
  int repeats = 9;
  int threads = 0;
  bool no_surface = false;
  bool no_film = false;
  bool overwrite = false;
};
/// What the columns mean, for the end of a command's help.
std::string study_columns();
void add_study_options(CLI::App& command, StudyArguments& arguments);
/// Throws ConfigError where --budget and the like are wrong.
tradeoff::StudyOptions study_options(const StudyArguments& arguments, const Scene& scene);
/// Share of the budget that is kept for the film of a study.
double film_share(const StudyArguments& arguments, bool has_folder);
/// Makes the folder of --out; none of its files is an input, or one that no study wrote unless `overwrite`.
/// Throws IoError.
void check_study_files(const std::filesystem::path& folder, const Scene& scene, bool overwrite);
/// The page with its film, the CSV and the JSON of a study. deadline: wall_clock() at which the film ends.
void write_study(const std::filesystem::path& folder, const tradeoff::Study& study,
                 const StudyArguments& arguments, const tradeoff::StudyOptions& options, double deadline,
                 const std::optional<tradeoff::Picked>& picked = {});
/// "60s", "5m", "16ms" or "60" in seconds. Throws ConfigError that names `option`.
double seconds_of(const std::string& text, const std::string& option);
/// "0.1h" or "0.1". Throws ConfigError that names `option`.
double spacings_of(const std::string& text, const std::string& option);

}  // namespace mallow::cli

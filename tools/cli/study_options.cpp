#include "cli/study_options.h"

#include <unistd.h>
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/film.h"
#include "program/interrupt.h"
#include "program/output_files.h"
#include "program/threads_option.h"
#include "tradeoff/films.h"
#include "tradeoff/page.h"

namespace mallow::cli {
namespace {

constexpr const char* k_film = "side_by_side.mp4";
constexpr double k_film_share = 0.1;

/// A number > 0 before `unit`; NaN where it is none.
double value_before(const std::string& text, const std::string& unit) {
  double value = std::nan("");
  if (!text.ends_with(unit)) return value;
  const char* const end = text.data() + text.size() - unit.size();
  const auto [read, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && read == end && std::isfinite(value) && value > 0 ? value : std::nan("");
}

}  // namespace

double seconds_of(const std::string& text, const std::string& option) {
  struct Unit {
    const char* name;
    double seconds;
  };
  for (const Unit& unit : {Unit{"ms", 1e-3}, Unit{"s", 1}, Unit{"m", 60}, Unit{"h", 3600}, Unit{"", 1}})
    if (const double value = value_before(text, unit.name); value > 0) return value * unit.seconds;
  throw ConfigError(option, "'" + text + "' is not allowed: a time > 0, like 16ms, 60s or 5m");
}

double spacings_of(const std::string& text, const std::string& option) {
  for (const char* unit : {"h", ""})
    if (const double value = value_before(text, unit); value > 0) return value;
  throw ConfigError(option, "'" + text + "' is not allowed: a number > 0 of spacings, like 0.1h");
}

std::string study_columns() {
  std::string text = "Columns of the table, in brackets those of tradeoff.csv:";
  for (const std::string& line : tradeoff::column_help()) text += "\n  " + line;
  return text;
}

void add_study_options(CLI::App& command, StudyArguments& arguments) {
  add_scene_options(command, arguments.scene);
  command
      .add_option("--budget", arguments.budget,
                  "Wall time of all runs, like 60s or 5m; what does not fit is left out, and said")
      ->capture_default_str();
  command
      .add_option("--knob", arguments.knobs,
                  "Run the scene at these values of a key too, before all others: --knob "
                  "solver.volume_iterations=0,3; 'mallow keys' lists what there is")
      ->option_text("KEY=A,B,...")
      ->allow_extra_args(false);
  command
      .add_option(
          "--measure", arguments.measures,
          "Tell the error of this too: height, top, extent_x, extent_y, center_x, center_y, center_z, "
          "volume, speed or kinetic_energy of a body, by name or number: --measure \"height(0)\"")
      ->allow_extra_args(false);
  command.add_option("--repeats", arguments.repeats, "Timed runs of every setting, at most")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  program::add_threads_option(command, arguments.threads);
  command.add_flag("--no-surface", arguments.no_surface, "Draw no surface: a frame is its steps alone");
  command.add_flag("--overwrite", arguments.overwrite,
                   "Replace files that are there, also those that no study wrote");
  command.add_flag(
      "--no-film", arguments.no_film,
      "Make no film of the scene as it is beside another setting; it takes a tenth of the budget");
}

tradeoff::StudyOptions study_options(const StudyArguments& arguments, const Scene& scene) {
  tradeoff::StudyOptions options{.budget = seconds_of(arguments.budget, "--budget"),
                                 .threads = arguments.threads,
                                 .repeats = arguments.repeats,
                                 .surface = !arguments.no_surface,
                                 .measures = arguments.measures};
  for (const std::string& text : arguments.knobs)
    for (tradeoff::Setting& setting :
         tradeoff::turned(scene, tradeoff::parse_knob(text), arguments.scene.overrides,
                          arguments.scene.allow_outside_paths))
      options.extra.push_back(std::move(setting));
  if (isatty(STDERR_FILENO) != 0)
    options.progress = [](const std::string& what) { std::fprintf(stderr, "%s\n", what.c_str()); };
  program::watch_for_interrupt();
  options.stop = [] { return program::interrupted() != 0; };
  return options;
}

void check_study_files(const std::filesystem::path& folder, const Scene& scene, bool overwrite) {
  const program::InputFiles inputs(scene);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError({folder.string(), 0, 0, "--out", "cannot be made: " + error.message()});
  // The table of a study tells that the files beside it are those of that study.
  bool is_study = false;
  for (const char* name : {"tradeoff.csv", "tradeoff.json", "index.html", k_film}) {
    program::check_writable(folder / name);
    inputs.refuse(folder / name, "--out");
    const program::IsOwn is_own = [&](std::string_view beginning) {
      is_study = is_study || beginning.starts_with("setting,frames,all_frames,on_front,");
      return is_study;
    };
    program::refuse_to_replace(folder / name, "--out",
                               overwrite ? program::Replace::overwrite : program::Replace::no, is_own);
  }
}

double film_share(const StudyArguments& arguments, bool has_folder) {
  return has_folder && !arguments.no_film && program::can_make_films() ? k_film_share : 0;
}

void write_study(const std::filesystem::path& folder, const tradeoff::Study& study,
                 const StudyArguments& arguments, const tradeoff::StudyOptions& options, double deadline,
                 const std::optional<tradeoff::Picked>& picked) {
  write_whole(folder / "tradeoff.csv", tradeoff::to_csv(study));
  write_whole(folder / "tradeoff.json", tradeoff::to_json(study, picked));
  const std::optional<std::size_t> row = picked && picked->holds ? std::optional(picked->row) : std::nullopt;
  const auto shown = tradeoff::row_to_show(study, row);
  std::optional<tradeoff::SideBySide> film;
  if (!arguments.no_film && shown) {
    if (options.progress) options.progress("a film, side by side");
    film = tradeoff::film_side_by_side(study, *shown, options, deadline, folder / k_film);
  }
  if (!film || film->file.empty()) {  // one of an earlier study
    std::error_code ignored;
    std::filesystem::remove(folder / k_film, ignored);
  }
  write_whole(folder / "index.html", tradeoff::to_page(study, row, film));
}

}  // namespace mallow::cli

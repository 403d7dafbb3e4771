#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/study_options.h"
#include "cli/tradeoff_command.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/cache.h"
#include "program/failure.h"
#include "program/interrupt.h"
#include "program/output_files.h"
#include "tradeoff/confirm.h"
#include "tradeoff/reference.h"
#include "tradeoff/runner.h"
#include "tradeoff/tables.h"

namespace mallow::cli {
namespace {
namespace fs = std::filesystem;

struct TuneOptions {
  StudyArguments study;
  std::string frame, error;
  std::string write, out;
};

/// Share of the budget that the runs that confirm get.
constexpr double k_confirm_share = 0.1;

std::string described(const tradeoff::Study& study, const tradeoff::Picked& picked) {
  const tradeoff::Row& row = study.rows[picked.row];
  const std::size_t runs = row.seconds.size();
  return tradeoff::number(1e3 * row.frame_seconds()) + " ms a frame (median of " + std::to_string(runs) +
         (runs == 1 ? " run, " : " runs, ") + tradeoff::number(1e3 * row.least_frame_seconds()) + " to " +
         tradeoff::number(1e3 * row.most_frame_seconds()) + "), " + tradeoff::number(study.error(row)) +
         " h off" +
         (picked.more > 0 ? "; run again " + tradeoff::number(picked.error) + " h off"
                          : "; not run again, as the budget ended");
}

/// What was measured, and the verdict where there is a pick; else require_pick() has it.
void print(const tradeoff::Study& study, const tradeoff::Picked& picked, const std::string& lines) {
  std::fputs(tradeoff::to_text(study).c_str(), stdout);
  for (const std::string& text : picked.dropped) std::printf("dropped: %s\n", text.c_str());
  if (picked.holds)
    std::printf("pick: %s: %s\n%s", study.rows[picked.row].setting.name.c_str(),
                described(study, picked).c_str(), lines.empty() ? "# the scene as it is\n" : lines.c_str());
  std::fflush(stdout);  // before what is told on the other stream
}

/// Throws RunFailure where nothing is to be written.
void require_pick(const TuneOptions& options, const tradeoff::Study& study, const tradeoff::Picked& picked) {
  const std::string limit = options.frame.empty() ? "--error " + options.error : "--frame " + options.frame;
  if (!picked.not_judged.empty())
    throw program::RunFailure("no pick: " + limit + " cannot be judged, as " + picked.not_judged);
  if (!picked.holds)
    throw program::RunFailure("no pick: no setting holds " + limit + "; the nearest is " +
                              study.rows[picked.row].setting.name + ", " + described(study, picked));
}

/// What the user has to know of a pick that holds.
void warn(const Scene& scene, const tradeoff::Limit& limit, const tradeoff::Study& study) {
  if (!tradeoff::stretch(study).empty())
    std::fprintf(
        stderr,
        "mallow: warning: judged by %s alone, which the budget carries: what comes later may cost and "
        "err more; more --budget, or less run.frames, judges more\n",
        tradeoff::stretch(study).c_str());
  if (!limit.is_time && study.reference_error() > tradeoff::k_reference_part * limit.most)
    std::fprintf(stderr, "mallow: warning: the reference itself is off by about %s h%s\n",
                 tradeoff::number(study.reference_error()).c_str(),
                 tradeoff::would_go_on(study.reference, scene, 1) ? ": more --budget tells more" : "");
}

void write(const fs::path& file, const tradeoff::Study& study, const tradeoff::Row& row) {
  const std::string part = tradeoff::stretch(study);
  write_whole(
      file,
      (part.empty() ? "" : "# " + row.setting.name + ": picked by mallow tune, judged by " + part + "\n") +
          program::Cache::scene_text(fs::absolute(file).parent_path(), row.setting.scene));
}

void tune(const TuneOptions& options, const Scene& scene, const tradeoff::StudyOptions& study_with,
          const tradeoff::Limit& limit) {
  const double deadline = tradeoff::wall_clock() + study_with.budget;
  tradeoff::Study study = tradeoff::study(scene, study_with);
  const double film = film_share(options.study, !options.out.empty()) * study_with.budget;
  const auto picked = tradeoff::confirm(study, limit, study_with, deadline - film);
  if (!picked) throw program::RunFailure("no setting could be measured");
  const tradeoff::Row& row = study.rows[picked->row];
  print(study, *picked, tradeoff::lines_to_paste(scene, row.setting.scene));
  if (!options.out.empty()) write_study(options.out, study, options.study, study_with, deadline, picked);
  require_pick(options, study, *picked);
  warn(scene, limit, study);
  if (!options.write.empty()) write(options.write, study, row);
}

void run(const TuneOptions& options) {
  if (options.frame.empty() == options.error.empty())
    throw ConfigError("", "one of --frame and --error is needed");
  const tradeoff::Limit limit = options.frame.empty()
                                    ? tradeoff::Limit{false, spacings_of(options.error, "--error")}
                                    : tradeoff::Limit{true, seconds_of(options.frame, "--frame")};
  const Scene scene = read_scene(options.study.scene);
  tradeoff::StudyOptions study_with = study_options(options.study, scene);
  study_with.kept = k_confirm_share + film_share(options.study, !options.out.empty());
  study_with.limit = limit;
  if (!options.write.empty()) {
    program::InputFiles(scene).refuse(options.write, "--write");
    program::check_writable(options.write);
    // One that was written before may have been worked on by hand since.
    program::refuse_to_replace(options.write, "--write",
                               options.study.overwrite ? program::Replace::overwrite : program::Replace::no);
  }
  if (!options.out.empty()) check_study_files(options.out, scene, options.study.overwrite);
  try {
    tune(options, scene, study_with, limit);
  } catch (const tradeoff::Stopped&) {
    throw program::Interrupted("interrupted; nothing is written", program::interrupted());
  }
}

}  // namespace

void add_tune_command(CLI::App& app) {
  const auto options = std::make_shared<TuneOptions>();
  CLI::App* command =
      app.add_subcommand("tune",
                         "Pick the cheapest setting of a scene that is accurate enough, or the most "
                         "accurate that is fast enough");
  add_study_options(*command, options->study);
  CLI::Option* frame = command->add_option(
      "--frame", options->frame, "Time that a frame may take, its steps and its surface, like 16ms");
  command->add_option("--error", options->error, "How far off it may be in spacings, like 0.1h")
      ->excludes(frame);
  command->add_option("--write", options->write,
                      "Write the scene at the pick to this file, with every value in it");
  command->add_option("--out", options->out, "Folder for the files that 'mallow tradeoff' writes");
  command->footer(
      "Measures as 'mallow tradeoff' does, turns knobs on from the best setting as long as that gets better, "
      "picks,\n"
      "and runs the pick again: times are medians of all runs. A scene that is longer than the budget is "
      "judged by\n"
      "its first frames, and that is said.\n"
      "'mallow tradeoff --help' explains the columns.\n"
      "Exit codes: 0 the pick holds, 1 none does, 2 the input is wrong.");
  command->callback([options] { run(*options); });
}

}  // namespace mallow::cli

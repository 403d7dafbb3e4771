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
#include "tradeoff/tables.h"

namespace mallow::cli {
namespace {
namespace fs = std::filesystem;

struct TuneOptions {
  StudyArguments study;
  std::string frame, error;
  std::string write, out;
};

/// Share of the budget that the study gets; the run that confirms gets the rest.
constexpr double k_study_share = 0.9;

std::string described(const tradeoff::Study& study, const tradeoff::Row& row) {
  return tradeoff::number(1e3 * row.frame_seconds()) + " ms a frame, " + tradeoff::number(study.error(row)) +
         " h off";
}

void tune(const TuneOptions& options, const Scene& scene, const tradeoff::StudyOptions& study_with,
          const tradeoff::Limit& limit) {
  const tradeoff::Study study = tradeoff::study(scene, study_with);
  std::fputs(tradeoff::to_text(study).c_str(), stdout);
  std::vector<Trade> trades = study.trades();
  std::optional<Pick> pick;
  tradeoff::Row again;
  bool confirmed = false;
  // What does not hold on a second run is no pick.
  for (std::size_t tries = 0; tries < trades.size() && !confirmed; ++tries) {
    const auto next = limit.pick(trades);
    if (pick && (!next || !next->holds)) break;
    pick = next;
    if (!pick) break;
    again = tradeoff::run_again(study, study.rows[pick->index].setting, study_with);
    const double found = limit.is_time ? again.frame_seconds() : study.error(again);
    confirmed = pick->holds && found <= limit.most;
    if (!pick->holds) break;
    if (!confirmed) trades[pick->index].cost = std::nan("");
  }
  if (!pick) throw program::RunFailure("no setting could be measured");
  const tradeoff::Row& row = study.rows[pick->index];
  std::printf("%s: %s: %s; on a second run %s\n", confirmed ? "pick" : "nearest", row.setting.name.c_str(),
              described(study, row).c_str(), described(study, again).c_str());
  if (!options.out.empty()) write_study(options.out, study, tradeoff::Picked{pick->index, confirmed, again});
  const std::string lines = tradeoff::lines_to_paste(scene, row.setting.scene);
  std::printf("%s", lines.empty() ? "# the scene as it is\n" : lines.c_str());
  // What the study could not see is no promise: matter that falls tells nothing of how it lands.
  if (study.frames < study.all_frames)
    throw program::RunFailure(
        "judged by the first " + std::to_string(study.frames) + " of " + std::to_string(study.all_frames) +
        " frames alone, as the budget ended: give more by --budget, or less run.frames; "
        "nothing is written");
  std::fflush(stdout);  // before what is told on the other stream
  if (!limit.is_time && study.reference_error() > limit.most)
    throw program::RunFailure(
        "--error " + options.error + " cannot be judged, as the reference itself is off by about " +
        tradeoff::number(study.reference_error()) + " h: give more by --budget; nothing is written");
  if (!confirmed)
    throw program::RunFailure("no setting holds " +
                              (limit.is_time ? "--frame " + options.frame : "--error " + options.error) +
                              "; the nearest is " + row.setting.name + ", " + described(study, row));
  if (!limit.is_time && study.reference_error() > 0.5 * limit.most)
    std::fprintf(stderr,
                 "mallow: warning: the reference itself is off by about %s h: more --budget tells more\n",
                 tradeoff::number(study.reference_error()).c_str());
  if (!options.write.empty())
    write_whole(options.write,
                program::Cache::scene_text(fs::absolute(options.write).parent_path(), row.setting.scene));
}

void run(const TuneOptions& options) {
  if (options.frame.empty() == options.error.empty())
    throw ConfigError("", "one of --frame and --error is needed");
  const tradeoff::Limit limit = options.frame.empty()
                                    ? tradeoff::Limit{false, spacings_of(options.error, "--error")}
                                    : tradeoff::Limit{true, seconds_of(options.frame, "--frame")};
  const Scene scene = read_scene(options.study.scene);
  tradeoff::StudyOptions study_with = study_options(options.study, scene);
  study_with.budget *= k_study_share;
  study_with.limit = limit;
  if (!options.write.empty()) {
    program::InputFiles(scene).refuse(options.write, "--write");
    program::check_writable(options.write);
  }
  if (!options.out.empty()) check_study_files(options.out, scene);
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
      "and runs the pick once more. How well a surface follows its particles is not measured: a quality with "
      "a coarser\n"
      "one is the cheaper for it, but with --no-surface.\n"
      "'mallow tradeoff --help' explains the columns.\n"
      "Exit codes: 0 the pick holds, 1 none does, 2 the input is wrong.");
  command->callback([options] { run(*options); });
}

}  // namespace mallow::cli

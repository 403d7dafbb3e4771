#include "cli/tradeoff_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "cli/study_options.h"
#include "program/failure.h"
#include "program/interrupt.h"
#include "tradeoff/runner.h"
#include "tradeoff/tables.h"

namespace mallow::cli {
namespace {

struct TradeoffOptions {
  StudyArguments study;
  std::string out;
};

void run(const TradeoffOptions& options) {
  const Scene scene = read_scene(options.study.scene);
  tradeoff::StudyOptions study_with = study_options(options.study, scene);
  study_with.kept = film_share(options.study, !options.out.empty());
  if (!options.out.empty()) check_study_files(options.out, scene, options.study.overwrite);
  try {
    const double deadline = tradeoff::wall_clock() + study_with.budget;
    const tradeoff::Study study = tradeoff::study(scene, study_with);
    std::fputs(tradeoff::to_text(study).c_str(), stdout);
    std::fflush(stdout);
    if (!options.out.empty()) write_study(options.out, study, options.study, study_with, deadline);
  } catch (const tradeoff::Stopped&) {
    throw program::Interrupted("interrupted; nothing is written", program::interrupted());
  }
}

}  // namespace

void add_tradeoff_command(CLI::App& app) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App* command = app.add_subcommand("tradeoff", "Measure what speed costs in accuracy on a scene");
  add_study_options(*command, options->study);
  command->add_option("--out", options->out,
                      "Folder for index.html, a page to look at with a film, tradeoff.csv and tradeoff.json");
  command->footer(
      "Runs the scene at settings around its own and compares each with a reference in far shorter steps, "
      "which\n"
      "are halved until that changes little, or half the budget is used. Errors are distances between "
      "particles\n"
      "of the same id, in spacings h. Where the motion is chaotic, which one more run tells that differs by "
      "the\n"
      "last bit, height, spread and centre over the last quarter are compared instead.\n" +
      study_columns());
  command->callback([options] { run(*options); });
}

}  // namespace mallow::cli

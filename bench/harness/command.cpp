#include "harness/command.h"

#include <CLI/CLI.hpp>

#include "mallow/errors.h"
#include "program/failure.h"
#include "program/interrupt.h"
#include "program/machine.h"
#include "program/threads_option.h"

namespace mallow::bench {

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      CommonOptions& options, const std::function<void()>& run) {
  CLI::App* command = app.add_subcommand(name, description);
  command->add_option("--out", options.output.folder, "Folder for JSON, CSV and pictures")
      ->capture_default_str();
  command->add_option("--json", options.output.json, "The JSON file, where it is to have another name");
  program::add_threads_option(*command, options.threads);
  command->callback([&options, run] {
    options.threads = program::resolve_threads(options.threads);
    program::watch_for_interrupt();
    run();
  });
  return command;
}

std::vector<std::string> chosen(const std::string& option, const std::vector<std::string>& asked,
                                std::span<const std::string> known) {
  if (asked.empty()) return {known.begin(), known.end()};
  std::string all;
  for (const std::string& name : known) all += (all.empty() ? "" : ", ") + name;
  std::vector<Problem> problems;
  for (const std::string& name : asked)
    if (std::find(known.begin(), known.end(), name) == known.end())
      problems.push_back({.field = option, .message = "\"" + name + "\" is not known; known are " + all});
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return asked;
}

void stop_if_interrupted(const Results& results) {
  if (!program::interrupted()) return;
  throw program::RunFailure("interrupted; the " + std::to_string(results.rows().size()) +
                            " rows that were finished are in " + results.file(".csv").string());
}

std::filesystem::path data_file(const std::string& name) {
  return std::filesystem::path(MALLOW_DATA_DIR) / name;
}

}  // namespace mallow::bench

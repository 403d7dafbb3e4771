#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "harness/results.h"

namespace CLI {
class App;
}

namespace mallow::bench {

/// What every command takes.
struct CommonOptions {
  Output output;
  int threads = 0;  ///< 0: all the machine has, resolved before the command runs
};

/// A command with --out, --json and --threads. `run` is called with threads resolved, and with Ctrl-C asking
/// to stop after the row at hand (stop_if_interrupted).
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      CommonOptions& options, const std::function<void()>& run);

/// The names that were asked for, all known ones where none were. Throws ConfigError that lists the known
/// ones where one is not among them. option: "--rows".
std::vector<std::string> chosen(const std::string& option, const std::vector<std::string>& asked,
                                std::span<const std::string> known);

/// Throws RunFailure when Ctrl-C was pressed; the rows so far are in `results` and stay.
void stop_if_interrupted(const Results& results);

/// A file of the project's data folder, "scenes/table1/bar_sigma8.toml".
std::filesystem::path data_file(const std::string& name);

}  // namespace mallow::bench

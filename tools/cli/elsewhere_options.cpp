#include "cli/elsewhere_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "mallow/errors.h"
#include "program/machine.h"

namespace mallow::cli {

void add_elsewhere_options(CLI::App& command, ElsewhereOptions& options, const std::string& what,
                           const std::vector<std::string>& places) {
  const bool lists = std::ranges::count(places, "list") > 0;
  command
      .add_option("--on", options.on,
                  "Where " + what + " are made: here, by GNU parallel, or by a job array of Slurm" +
                      (lists ? "; list: print a command for each, for any other scheduler" : ""))
      ->check(CLI::IsMember(places));
  command
      .add_option(
          "--jobs", options.jobs,
          (lists ? std::string("Points at a time; 0: one for each processor, or as the scheduler has it")
                 : "With --on: tasks at a time; 0: as the scheduler has room"))
      ->check(CLI::Range(0, 1'000'000));
  command.add_option("--hosts", options.hosts,
                     "For --on parallel: a file of hosts for ssh, which see the same folders");
  command
      .add_option("--sbatch", options.slurm_options,
                  "For --on slurm: an option of sbatch, --sbatch=--partition=long")
      ->allow_extra_args(false);
}

void check(const ElsewhereOptions& options) {
  if (!options.hosts.empty() && options.on != "parallel")
    throw ConfigError("--hosts", "is not allowed without --on parallel");
  if (!options.slurm_options.empty() && options.on != "slurm")
    throw ConfigError("--sbatch", "is not allowed without --on slurm");
  if (!options.hosts.empty() && !std::filesystem::exists(options.hosts))
    throw IoError({options.hosts, 0, 0, "--hosts", "is not there"});
}

sweep::Elsewhere elsewhere(const ElsewhereOptions& options, const std::string& folder,
                           const std::string& name) {
  return {.folder = folder,
          .name = name,
          .jobs = options.jobs,
          .hosts = options.hosts,
          .slurm_options = options.slurm_options};
}

int threads_of_task(const ElsewhereOptions& options, int threads) {
  if (threads > 0 || options.on == "slurm") return threads;
  // GNU parallel runs a task on each processor, here or there, unless --jobs says how many.
  if (options.on != "parallel" || options.jobs == 0 || !options.hosts.empty()) return 1;
  return std::max(1, program::resolve_threads(0) / options.jobs);
}

std::string run_elsewhere(const ElsewhereOptions& options, const sweep::Tasks& tasks,
                          const sweep::Elsewhere& where) {
  if (options.on == "parallel") return sweep::run_by_parallel(tasks, where);
  sweep::run_by_slurm(tasks, where);
  return "";
}

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::vector<std::string> words_of(const CLI::App& command, const std::vector<std::string>& without) {
  std::vector<std::string> words{own_program(), command.get_name()};
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    const bool left_out = std::ranges::count(std::array{"--on", "--jobs", "--hosts", "--sbatch"}, name) > 0 ||
                          std::ranges::count(without, name) > 0;
    if (option->count() == 0 || left_out) continue;
    if (option->get_expected_max() == 0) {
      words.push_back(name);
      continue;
    }
    for (const std::string& value : option->results())
      words.push_back(option->get_positional() ? value : name + '=' + value);
  }
  return words;
}

}  // namespace mallow::cli

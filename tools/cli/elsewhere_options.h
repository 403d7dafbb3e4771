#pragma once

#include <string>
#include <vector>

#include "sweep/schedulers.h"

namespace CLI {
class App;
}

namespace mallow::cli {

/// Where the work of a command is done: in this process, or by a scheduler that runs tasks of it.
struct ElsewhereOptions {
  std::string on = "local";
  int jobs = 0;  ///< at a time; 0: as the scheduler has room
  std::string hosts;
  std::vector<std::string> slurm_options;

  bool by_scheduler() const { return on == "parallel" || on == "slurm"; }
};
/// --on, of `places`, --jobs, --hosts and --sbatch. what: "Points", for the help.
void add_elsewhere_options(CLI::App& command, ElsewhereOptions& options, const std::string& what,
                           const std::vector<std::string>& places);
/// Throws ConfigError where an option is given that the place does not have.
void check(const ElsewhereOptions& options);

/// What all schedulers are told. folder: for their lists and logs. name: of the job.
sweep::Elsewhere elsewhere(const ElsewhereOptions& options, const std::string& folder,
                           const std::string& name);
/// For --threads of a task: `threads` where it is given; else those of its slot, which tasks of Slurm find
/// themselves: 0.
int threads_of_task(const ElsewhereOptions& options, int threads);
/// Runs tasks by the scheduler that --on names, which is one. Returns what was said of hosts that could not
/// be reached. Throws what run_by_parallel() and run_by_slurm() throw.
std::string run_elsewhere(const ElsewhereOptions& options, const sweep::Tasks& tasks,
                          const sweep::Elsewhere& where);

/// The program that runs, by the name that others can start it with.
std::string own_program();
/// The words of a command line as it was given, but for options of ElsewhereOptions and those named in
/// `without`: {"mallow", "surface", "DIR", "--set=a=b"}.
std::vector<std::string> words_of(const CLI::App& command, const std::vector<std::string>& without);

}  // namespace mallow::cli

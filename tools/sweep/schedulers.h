#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mallow::sweep {

/// Tasks for a scheduler of others. Each is the same command with one more word behind it.
struct Tasks {
  std::vector<std::string> command;
  std::vector<std::string> words;  ///< one a task: "--point=3,4"
};

/// How they are run there.
struct Elsewhere {
  std::filesystem::path folder;            ///< for the list of tasks, and what the scheduler says
  std::string name;                        ///< of the job: "mallow-sweep"
  int jobs = 0;                            ///< at once; 0: as many as there is room for
  std::string hosts;                       ///< a file of them, for GNU parallel; may be empty
  std::vector<std::string> slurm_options;  ///< for sbatch: "--partition=long"
};

/// By GNU parallel, also over ssh. What tasks do not get done is left to whoever knows what they were to do.
/// Returns what it said of hosts that could not be reached; mostly nothing. Throws RunFailure where it is
/// missing, Interrupted at Ctrl-C.
std::string run_by_parallel(const Tasks& tasks, const Elsewhere& where);
/// As a job array of Slurm, and waits for it. Throws RunFailure where it is missing or refuses the job.
/// Throws Interrupted at Ctrl-C, once the job is cancelled.
void run_by_slurm(const Tasks& tasks, const Elsewhere& where);
/// As many tasks as a job array can have: one less than the cluster's MaxArraySize.
std::size_t most_slurm_tasks(const Elsewhere& where);

}  // namespace mallow::sweep

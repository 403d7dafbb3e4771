#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sweep/sweep_points.h"

namespace mallow::sweep {

/// "3", "4:9", "3,7,4:9", B not included: points below `count`. Throws ConfigError.
std::vector<std::size_t> point_list(const std::string& text, std::size_t count);

/// Where points are run that are not here.
struct Elsewhere {
  std::vector<std::string> command;        ///< the sweep command of one task, but for its --point
  int jobs = 0;                            ///< at once; 0: as many as there is room for
  std::string hosts;                       ///< a file of them, for GNU parallel; may be empty
  int points_per_task = 1;                 ///< at least
  std::vector<std::string> slurm_options;  ///< for sbatch: "--partition=long"
};

/// Runs points here, `jobs` at a time, each on so many threads; `ran` is told of each, one at a time. Throws
/// what SweepFolder::run() throws, once those that run have ended.
void run_here(const SweepFolder& sweep, std::span<const std::size_t> points, int jobs, int threads,
              const std::function<void(std::size_t, const Outcome&)>& ran);
/// By GNU parallel, also over ssh. What it could not run stays open. Throws RunFailure where it is missing.
void run_by_parallel(const SweepFolder& sweep, std::span<const std::size_t> points, const Elsewhere& where);
/// As a job array of Slurm, and waits for it. What it could not run stays open. Throws RunFailure where it is
/// missing or refuses the job.
void run_by_slurm(const SweepFolder& sweep, std::span<const std::size_t> points, const Elsewhere& where);

}  // namespace mallow::sweep

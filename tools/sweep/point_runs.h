#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sweep/sweep_points.h"

namespace mallow::sweep {

/// "3", "4:9", "3,7,4:9", B not included: points below `count`, none twice. Throws ConfigError.
std::vector<std::size_t> point_list(const std::string& text, std::size_t count);
/// The reverse for the tasks of a scheduler: "--point=3,4" for each `each` points.
std::vector<std::string> point_words(std::span<const std::size_t> points, std::size_t each);

/// Runs points here, `jobs` at a time, each on so many threads; `ran` is told of each, one at a time. Throws
/// what SweepFolder::run() throws, once those that run have ended.
void run_here(const SweepFolder& sweep, std::span<const std::size_t> points, int jobs, int threads,
              const std::function<void(std::size_t, const Outcome&)>& ran);

}  // namespace mallow::sweep

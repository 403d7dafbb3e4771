#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace mallow {

/// Runs `work`, and all that TBB starts in it, on at most `threads` threads; 0 takes what the machine has.
template <class Work>
auto run_with_threads(int threads, Work&& work) {
  // More threads than processors are given too, instead of a warning that TBB prints.
  const int most = std::max(threads, tbb::info::default_concurrency());
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(most));
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute(std::forward<Work>(work));
}

}  // namespace mallow

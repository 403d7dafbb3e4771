#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/threads.h"

namespace mallow {

/// Runs `work`, and all that TBB starts in it, on at most so many of TBB's threads.
template <class Work>
auto run_with_threads(const Threads& threads, Work&& work) {
  // More threads than processors are given too, instead of a warning that TBB prints.
  const int most = std::max(threads.count(), tbb::info::default_concurrency());
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(most));
  tbb::task_arena arena(threads.count());
  return arena.execute(std::forward<Work>(work));
}

}  // namespace mallow

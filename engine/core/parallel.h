#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "core/threads.h"
#include "mallow/export.h"

namespace mallow {

/// Particles per unit of work. Fixed, so that what is summed per block does not depend on the number of
/// threads; a whole number of lane blocks.
inline constexpr std::size_t k_block = 256;

/// Whether this thread is in a loop's body. A loop in there runs on this thread alone.
inline constinit thread_local bool t_in_loop = false;

/// Blocks that threads hand out to each other: each thread starts on a range of its own, the same in every
/// loop over as many blocks, so that what it wrote in one phase is in its cache in the next; one that is
/// done takes from the ranges of others.
class SharedBlocks {
 public:
  /// More threads share ranges: they take no memory, and neighbours of a block stay few cores away.
  static constexpr std::size_t k_max_ranges = 64;
  static std::size_t ranges(const Threads& threads) {
    return std::min(static_cast<std::size_t>(threads.count()), k_max_ranges);
  }
  /// The range that a block is in.
  static std::size_t range_of(std::size_t block, std::size_t ranges, std::size_t blocks) {
    return ((block + 1) * ranges - 1) / blocks;
  }

  SharedBlocks(std::size_t ranges, std::size_t blocks) : ranges_(ranges) {
    for (std::size_t r = 0; r < ranges_; ++r) {
      next_[r].block.store(r * blocks / ranges_, std::memory_order_relaxed);
      next_[r].end = (r + 1) * blocks / ranges_;
    }
  }
  /// Calls run(block) until no block is left.
  template <class Run>
  void work(std::size_t place, const Run& run) {
    for (std::size_t k = 0; k < ranges_; ++k) {
      Range& range = next_[(place + k) % ranges_];
      for (;;) {
        const std::size_t block = range.block.fetch_add(1, std::memory_order_relaxed);
        if (block >= range.end) break;
        run(block);
      }
    }
  }

 private:
  struct alignas(64) Range {
    std::atomic<std::size_t> block;
    std::size_t end;
  };
  std::size_t ranges_;
  Range next_[k_max_ranges];
};

/// Runs a loop on the threads of an executor, and on this one what they leave.
MALLOW_EXPORT void run_loop(const Threads& threads, LoopTask task);

/// Calls body(begin, end) for every block of `block` indices of [0, n), blocks spread over threads. The
/// blocks are the same for any number of threads. body must not throw.
template <class Body>
void parallel_for(const Threads& threads, std::size_t n, const Body& body, std::size_t block = k_block) {
  const std::size_t blocks = (n + block - 1) / block;
  const auto run = [&](std::size_t b) { body(b * block, std::min(n, (b + 1) * block)); };
  if (threads.count() == 1 || blocks <= 1 || t_in_loop) {
    for (std::size_t b = 0; b < blocks; ++b) run(b);
    return;
  }
  struct Loop {
    SharedBlocks shared;
    const decltype(run)& run_block;
  } loop{{SharedBlocks::ranges(threads), blocks}, run};
  const auto work = [](void* of, std::size_t place) noexcept {
    Loop& here = *static_cast<Loop*>(of);
    t_in_loop = true;
    here.shared.work(place, here.run_block);
    t_in_loop = false;
  };
  run_loop(threads.at_most(blocks), LoopTask(work, &loop));
}

/// combine(... combine(combine(identity, map(block 0)), map(block 1)) ...): one order for any number of
/// threads. `partial` is scratch that keeps its memory between calls.
template <class T, class Map, class Combine>
T parallel_reduce(const Threads& threads, std::size_t n, std::vector<T>& partial, T identity, const Map& map,
                  const Combine& combine) {
  partial.resize((n + k_block - 1) / k_block, identity);
  parallel_for(threads, n,
               [&](std::size_t begin, std::size_t end) { partial[begin / k_block] = map(begin, end); });
  for (const T& value : partial) identity = combine(identity, value);
  return identity;
}

}  // namespace mallow

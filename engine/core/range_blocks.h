#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace mallow {

/// Several ranges of rows, each cut into blocks of k_block rows from its begin on, which threads share as if
/// they were those of one range: a thousand small ranges take as long as a large one. The blocks are the same
/// for any number of threads.
struct RangeBlocks {
  struct Block {
    std::uint32_t range;
    std::uint32_t begin, end;  ///< rows of the range
  };
  std::vector<Block> blocks;
  std::vector<std::uint32_t> first{0};  ///< block of each range, and one more

  std::size_t ranges() const { return first.size() - 1; }
  void clear() {
    blocks.clear();
    first.assign(1, 0);
  }
  /// One more range, of `size` rows.
  void add(std::size_t size) {
    const auto range = static_cast<std::uint32_t>(ranges());
    for (std::size_t begin = 0; begin < size; begin += k_block)
      blocks.push_back({range, static_cast<std::uint32_t>(begin),
                        static_cast<std::uint32_t>(std::min(size, begin + k_block))});
    first.push_back(static_cast<std::uint32_t>(blocks.size()));
  }
};

/// Calls body(block, number of the block) for every block, spread over threads. body must not throw.
template <class Body>
void parallel_for(const Threads& threads, const RangeBlocks& of, const Body& body) {
  parallel_for(
      threads, of.blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) body(of.blocks[b], b);
      },
      1);
}

}  // namespace mallow

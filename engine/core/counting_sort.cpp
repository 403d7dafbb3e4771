#include "core/counting_sort.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "core/sort_lanes.h"

namespace mallow {
namespace {

/// Keys that one thread handles at a time, and keys that it handles alone.
constexpr std::size_t k_key_block = 8192;
constexpr std::size_t k_few_keys = 16 * k_key_block;
/// Items that one thread counts in less time than several take to hand each other their counts.
constexpr std::size_t k_least_chunk = 16384;

/// Counts of chunk after chunk become places.
void scan_counts(std::size_t keys, std::size_t chunks, const Threads& threads, const SortLanes& lanes,
                 CountingSort& scratch, std::uint32_t* starts) {
  std::uint32_t* const counts = scratch.counts.data();
  if (chunks == 1 && keys <= k_few_keys) {
    starts[keys] = lanes.counts_to_places(counts, chunks, keys, 0, keys, 0, starts);
    return;
  }
  scratch.block_sums.resize((keys + k_key_block - 1) / k_key_block);
  parallel_for(
      threads, keys,
      [&](std::size_t first, std::size_t last) {
        std::uint32_t sum = 0;
        for (std::size_t c = 0; c < chunks; ++c)
          for (std::size_t key = first; key < last; ++key) sum += counts[c * keys + key];
        scratch.block_sums[first / k_key_block] = sum;
      },
      k_key_block);
  std::uint32_t start = 0;
  for (std::uint32_t& sum : scratch.block_sums) start += std::exchange(sum, start);
  starts[keys] = start;
  parallel_for(
      threads, keys,
      [&](std::size_t first, std::size_t last) {
        lanes.counts_to_places(counts, chunks, keys, first, last, scratch.block_sums[first / k_key_block],
                               starts);
      },
      k_key_block);
}

}  // namespace

void sort_by_key(const Column<std::uint32_t>& key, std::size_t keys, const Execution& execution,
                 CountingSort& scratch, Column<std::uint32_t>& start, Column<std::uint32_t>& order) {
  const std::size_t n = key.size();
  start.resize(keys + 1);
  order.resize(n);
  // A thread counts and places a chunk of the items, in order: the sort is stable whatever the chunks are.
  // More chunks than these would count more keys than items.
  const std::size_t chunks = std::clamp<std::size_t>(std::min(4 * n / keys, n / k_least_chunk), 1,
                                                     static_cast<std::size_t>(execution.threads.count()));
  const std::size_t chunk = (n + chunks - 1) / chunks;
  scratch.counts.resize(chunks * keys);
  const auto counts_of = [&](std::size_t item) { return scratch.counts.data() + item / chunk * keys; };
  parallel_for(
      execution.threads, n,
      [&](std::size_t first, std::size_t last) {
        std::uint32_t* const counts = counts_of(first);
        std::fill_n(counts, keys, 0u);
        for (std::size_t i = first; i < last; ++i) ++counts[key[i]];
      },
      chunk);
  scan_counts(keys, (n + chunk - 1) / chunk, execution.threads, MALLOW_SELECT(execution.level, sort_lanes),
              scratch, start.data());
  parallel_for(
      execution.threads, n,
      [&](std::size_t first, std::size_t last) {
        std::uint32_t* const next = counts_of(first);
        for (std::size_t i = first; i < last; ++i) order[next[key[i]]++] = static_cast<std::uint32_t>(i);
      },
      chunk);
}

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "mallow/export.h"
#include "mallow/instruction_level.h"

namespace mallow {

/// Memory of a sort, kept for the next.
struct CountingSort {
  Column<std::uint32_t> counts;
  std::vector<std::uint32_t> block_sums;

  std::size_t bytes() const { return counts.bytes(); }
};

/// Sorts items by keys that are small numbers, such as the cells that points lie in: count, scan, scatter.
/// The sort is stable, so its order is the same for any number of threads.
/// key: of each item, below `keys`. start: becomes keys + 1 long, the first place of each key. order: becomes
/// the item of each place.
MALLOW_EXPORT void sort_by_key(const Column<std::uint32_t>& key, std::size_t keys, const Execution& execution,
                               CountingSort& scratch, Column<std::uint32_t>& start,
                               Column<std::uint32_t>& order);

}  // namespace mallow

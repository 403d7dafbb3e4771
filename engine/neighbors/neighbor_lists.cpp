#include "neighbors/neighbor_lists.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "core/parallel.h"
#include "mallow/errors.h"
#include "neighbors/search_kernel.h"

namespace mallow {
namespace {

/// Rows of cells (same y and z) are the unit of work: every point is in one, in sorted order.
constexpr std::size_t k_rows_per_block = 4;
/// Candidates that one call of the kernel looks at, about: bounds the scratch where many points share a cell.
constexpr std::size_t k_batch = 1 << 16;
/// Entries that 32-bit places can name.
constexpr std::size_t k_max_entries = std::numeric_limits<std::uint32_t>::max();

struct Builder {
  const CellGrid& grid;
  const SearchKernels& kernels;
  SearchInput input;
  NeighborLists& lists;
  std::atomic<std::size_t> used{0};   ///< entries handed out, also beyond capacity
  std::atomic<std::size_t> total{0};  ///< entries that are neighbours

  /// Searches the cells of rows [begin, end) into `found`, then hands them a place of their own in `indices`.
  void build_rows(std::size_t begin, std::size_t end, std::vector<std::uint32_t>& found) {
    const auto nx = static_cast<std::size_t>(grid.dims[0]), ny = static_cast<std::size_t>(grid.dims[1]);
    const std::size_t first_point = grid.cell_start[begin * nx], last_point = grid.cell_start[end * nx];
    if (first_point == last_point) return;
    std::size_t size = 0;
    for (std::size_t row = begin; row < end; ++row) {
      int cell[3] = {0, static_cast<int>(row % ny), static_cast<int>(row / ny)};
      for (std::size_t c = row * nx; c < (row + 1) * nx; ++c, ++cell[0]) {
        std::size_t point = grid.cell_start[c];
        const std::size_t cell_end = grid.cell_start[c + 1];
        if (point == cell_end) continue;
        const std::size_t candidates = std::max<std::size_t>(1, kernels.candidates(input, cell));
        while (point < cell_end) {
          const std::size_t batch_end =
              std::min(cell_end, point + std::max<std::size_t>(1, k_batch / candidates));
          const std::size_t need = size + candidates * (batch_end - point);
          if (found.size() < need) found.resize(std::max(need, 2 * found.size()));
          size += kernels.search(input, cell, point, batch_end, found.data() + size, lists.count.data());
          point = batch_end;
          if (size > k_max_entries) {
            used.fetch_add(size, std::memory_order_relaxed);
            size = 0;
          }
        }
      }
    }
    const std::size_t place = used.fetch_add(size, std::memory_order_relaxed);
    total.fetch_add(size, std::memory_order_relaxed);
    if (place + size > lists.indices.size()) return;
    std::copy_n(found.data(), size, lists.indices.data() + place);
    std::size_t next = place;
    for (std::size_t i = first_point; i < last_point; ++i) {
      lists.begin[i] = static_cast<std::uint32_t>(next);
      next += lists.count[i];
    }
  }
};

}  // namespace

void build_neighbor_lists(const CellGrid& grid, float radius, int threads, InstructionLevel level,
                          NeighborLists& lists, std::size_t capacity) {
  const std::size_t n = grid.order.size();
  lists.begin.resize(n);
  lists.count.resize(n);
  if (lists.indices.empty()) lists.indices.resize(capacity > 0 ? capacity : 40 * n);
  const auto rows = static_cast<std::size_t>(grid.dims[1]) * static_cast<std::size_t>(grid.dims[2]);
  const SearchInput input{{grid.sorted.x(), grid.sorted.y(), grid.sorted.z()},
                          grid.cell_start.data(),
                          {grid.dims[0], grid.dims[1], grid.dims[2]},
                          radius * radius};
  for (;;) {
    Builder builder{grid, MALLOW_SELECT(level, search_kernels), input, lists, {}, {}};
    parallel_for(
        threads, rows,
        [&](std::size_t begin, std::size_t end) {
          thread_local std::vector<std::uint32_t> found;
          builder.build_rows(begin, end, found);
        },
        k_rows_per_block);
    lists.total = builder.total;
    if (builder.used > k_max_entries)
      throw ConfigError("support_radius", "the neighbour lists would need " + std::to_string(builder.used) +
                                              " entries; at most 4294967295 fit: choose a smaller radius");
    if (builder.used <= lists.indices.size()) return;
    // A tenth more than needed now, so that a body under compression does not grow the lists at every step.
    lists.indices.resize(0);
    lists.indices.resize(builder.used + builder.used / 10);
  }
}

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "neighbors/cell_grid.h"
#include "neighbors/cluster_lists.h"

namespace mallow {

/// Lists of sorted places of a grid, one a point or one a cluster, in an order that the points alone decide.
/// Lists of one block of clusters lie together; where a block lies in `indices` may differ from search to
/// search, what a list holds does not.
struct NeighborLists {
  Column<std::uint32_t> begin;    ///< where each list starts in `indices`
  Column<std::uint32_t> count;    ///< how long it is
  Column<std::uint32_t> indices;  ///< the lists, with unused space between blocks
  std::size_t total = 0;          ///< sum of all counts
  /// Per range of blocks that a thread starts on: where its share of `indices` ends.
  std::vector<std::size_t> share_end;

  std::span<const std::uint32_t> of(std::size_t i) const { return {indices.data() + begin[i], count[i]}; }
  double average() const {
    return count.empty() ? 0.0 : static_cast<double>(total) / static_cast<double>(count.size());
  }
  std::size_t bytes() const { return begin.bytes() + count.bytes() + indices.bytes(); }
};

/// Per sorted point all points within the radius, itself included.
/// grid: built with at least `radius`. Grows `indices` as needed. Throws ConfigError where the lists would
/// need 2^32 entries.
void build_neighbor_lists(const CellGrid& grid, float radius, const Execution& execution,
                          NeighborLists& lists);

/// Per cluster all points within the radius of its box, and so all that are within the radius of one of its
/// points: about twice as many as a point has, searched once for eight [Pall & Hess 2013]. Otherwise as
/// above.
void build_cluster_lists(const CellGrid& grid, float radius, const Execution& execution,
                         NeighborLists& lists);

/// The lists of the clusters of a grid as lanes read them.
inline ClusterLists view(const CellGrid& grid, const NeighborLists& lists) {
  return {.first = grid.cluster_start.data(),
          .begin = lists.begin.data(),
          .count = lists.count.data(),
          .indices = lists.indices.data(),
          .row_of = grid.order.data()};
}

}  // namespace mallow

#include "neighbors/neighbor_lists.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "core/parallel.h"
#include "mallow/errors.h"
#include "neighbors/search_lanes.h"

namespace mallow {
namespace {

/// Clusters are the unit of work: every point is in one, in sorted order.
constexpr std::size_t k_clusters_per_block = 32;
/// Entries of a block that a thread has room for from the start: several times as many as usual, as nobody
/// knows when it will first meet a crowded one, and steps are not to allocate.
constexpr std::size_t k_block_entries = 1024 * k_clusters_per_block;
/// Entries that 32-bit places can name with a tenth to spare.
constexpr std::size_t k_max_entries = std::numeric_limits<std::uint32_t>::max() / std::size_t{11} * 10;

/// What a thread needs for the lists of one block.
struct Scratch {
  std::vector<PlaceRange> ranges;
  std::vector<std::uint32_t> near_cluster;
  std::vector<float> x, y, z;
  std::vector<std::uint32_t> found;  ///< the lists of the block so far
  std::size_t size = 0;              ///< entries of them

  /// Room for `count` more entries; what lanes write beyond the last is included.
  std::uint32_t* room(std::size_t count) {
    const std::size_t need = size + count + k_cluster;
    if (found.size() < need) found.resize(std::max({need, 2 * found.size(), k_block_entries}));
    return found.data() + size;
  }
};

struct Searcher {
  const CellGrid& grid;
  const SearchLanes& lanes;
  SearchInput input;

  Searcher(const CellGrid& cells, float radius, InstructionLevel level)
      : grid(cells), lanes(MALLOW_SELECT(level, search_lanes)), input(search_input(cells, radius)) {}

  /// Appends the list of a cluster.
  void find_near_cluster(std::size_t cluster, Scratch& scratch, std::uint32_t* count) const {
    const Bounds box = lanes.box_of(input, cluster);
    std::size_t most = 0;
    const std::size_t ranges = find_ranges(box, scratch, most);
    count[cluster] = static_cast<std::uint32_t>(
        lanes.near_cluster(input, box, scratch.ranges.data(), ranges, scratch.room(most)));
    scratch.size += count[cluster];
  }
  /// Appends the lists of a cluster's points.
  void find_near_points(std::size_t cluster, Scratch& scratch, std::uint32_t* count) const {
    const Bounds box = lanes.box_of(input, cluster);
    std::size_t most = 0;
    const std::size_t ranges = find_ranges(box, scratch, most);
    scratch.near_cluster.resize(std::max(scratch.near_cluster.size(), most + k_cluster));
    const std::size_t n =
        lanes.near_cluster(input, box, scratch.ranges.data(), ranges, scratch.near_cluster.data());
    for (std::vector<float>* values : {&scratch.x, &scratch.y, &scratch.z})
      values->resize(std::max(values->size(), n + k_cluster));
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t place = scratch.near_cluster[k];
      scratch.x[k] = input.sorted.x[place];
      scratch.y[k] = input.sorted.y[place];
      scratch.z[k] = input.sorted.z[place];
    }
    for (std::size_t i = input.cluster_start[cluster]; i < input.cluster_start[cluster + 1]; ++i) {
      count[i] = static_cast<std::uint32_t>(
          lanes.near_point(input, i, n, scratch.near_cluster.data(),
                           {scratch.x.data(), scratch.y.data(), scratch.z.data()}, scratch.room(n)));
      scratch.size += count[i];
    }
  }

 private:
  std::size_t find_ranges(const Bounds& box, Scratch& scratch, std::size_t& points) const {
    if (scratch.ranges.size() < grid.pillars() + 1) scratch.ranges.resize(2 * (grid.pillars() + 1));
    const std::size_t ranges = lanes.find_ranges(input, box, scratch.ranges.data());
    for (std::size_t r = 0; r < ranges; ++r) points += scratch.ranges[r].end - scratch.ranges[r].begin;
    return ranges;
  }
};

/// Hands out room for lists. A thread starts on the same range of blocks in every step, and a range has a
/// share of its own: what a thread writes is where it wrote before, in its cache and not in another's.
class Shares {
 public:
  explicit Shares(const std::vector<std::size_t>& ends) : count_(ends.size()) {
    for (std::size_t r = 0; r < count_; ++r) {
      shares_[r].next.store(r > 0 ? ends[r - 1] : 0, std::memory_order_relaxed);
      shares_[r].needed.store(0, std::memory_order_relaxed);
      shares_[r].end = ends[r];
    }
  }
  static constexpr std::size_t k_no_room = SIZE_MAX;
  /// Room for `size` entries of a range, if need be of another's share. What finds a share too short closes
  /// it.
  std::size_t place(std::size_t range, std::size_t size) {
    shares_[range].needed.fetch_add(size, std::memory_order_relaxed);
    for (std::size_t k = 0; k < count_; ++k) {
      Share& share = shares_[(range + k) % count_];
      const std::size_t place = share.next.fetch_add(size, std::memory_order_relaxed);
      if (place + size <= share.end) return place;
    }
    return k_no_room;
  }
  std::size_t needed() const {
    std::size_t sum = 0;
    for (std::size_t r = 0; r < count_; ++r) sum += shares_[r].needed;
    return sum;
  }
  /// Divides `size` entries as they are needed now.
  void divide(std::size_t size, std::vector<std::size_t>& ends) const {
    const double each = static_cast<double>(size) / static_cast<double>(std::max<std::size_t>(1, needed()));
    double end = 0;
    for (std::size_t r = 0; r < count_; ++r) {
      end += each * static_cast<double>(shares_[r].needed);
      ends[r] = std::min(size, static_cast<std::size_t>(end));
    }
    ends.back() = size;
  }

 private:
  struct alignas(64) Share {
    std::atomic<std::size_t> next, needed;
    std::size_t end;
  };
  std::size_t count_;
  std::array<Share, SharedBlocks::k_max_ranges> shares_;
};

/// Searches all clusters; a block's lists get a place of their own in `indices`. row(cluster): the first list
/// of a cluster. search(cluster, scratch) appends its lists and sets their counts.
template <class Row, class Search>
void build_lists(std::size_t clusters, const Threads& threads, NeighborLists& lists, const Row& row,
                 const Search& search) {
  const std::size_t ranges = SharedBlocks::ranges(threads);
  const std::size_t blocks = (clusters + k_clusters_per_block - 1) / k_clusters_per_block;
  if (lists.share_end.size() != ranges) {
    lists.share_end.resize(ranges);
    for (std::size_t r = 0; r < ranges; ++r) lists.share_end[r] = (r + 1) * lists.indices.size() / ranges;
  }
  for (;;) {
    Shares shares(lists.share_end);
    std::atomic<bool> all_placed = true;
    parallel_for(
        threads, clusters,
        [&](std::size_t first, std::size_t last) {
          thread_local Scratch scratch;
          scratch.size = 0;
          const std::size_t range = SharedBlocks::range_of(first / k_clusters_per_block, ranges, blocks);
          for (std::size_t cluster = first; cluster < last; ++cluster) {
            search(cluster, scratch);
            if (scratch.size <= k_max_entries) continue;
            shares.place(range, scratch.size);  // far too many: only count on
            scratch.size = 0;
          }
          const std::size_t place = shares.place(range, scratch.size);
          if (place == Shares::k_no_room) {
            all_placed.store(false, std::memory_order_relaxed);
            return;
          }
          std::copy_n(scratch.found.data(), scratch.size, lists.indices.data() + place);
          std::size_t next = place;
          for (std::size_t i = row(first); i < row(last); ++i) {
            lists.begin[i] = static_cast<std::uint32_t>(next);
            next += lists.count[i];
          }
        },
        k_clusters_per_block);
    lists.total = shares.needed();
    if (lists.total > k_max_entries)
      throw ConfigError("support_radius", "the neighbour lists would need " + std::to_string(lists.total) +
                                              " entries; at most " + std::to_string(k_max_entries) +
                                              " fit: choose a smaller radius");
    if (!all_placed) {
      // A tenth more than needed now, so that a body under compression does not grow the lists at every step.
      lists.indices.resize(0);
      lists.indices.resize(lists.total + lists.total / 10 + ranges);
    }
    shares.divide(lists.indices.size(), lists.share_end);
    if (all_placed) return;
  }
}

}  // namespace

void build_neighbor_lists(const CellGrid& grid, float radius, const Execution& execution,
                          NeighborLists& lists) {
  const std::size_t n = grid.order.size();
  lists.begin.resize(n);
  lists.count.resize(n);
  if (lists.indices.empty()) lists.indices.resize(40 * n);
  const Searcher searcher(grid, radius, execution.level);
  build_lists(
      grid.clusters(), execution.threads, lists,
      [&](std::size_t cluster) { return grid.cluster_start[cluster]; },
      [&](std::size_t cluster, Scratch& scratch) {
        searcher.find_near_points(cluster, scratch, lists.count.data());
      });
}

void build_cluster_lists(const CellGrid& grid, float radius, const Execution& execution,
                         NeighborLists& lists) {
  lists.begin.resize(grid.clusters());
  lists.count.resize(grid.clusters());
  if (lists.indices.empty()) lists.indices.resize(128 * grid.clusters());
  const Searcher searcher(grid, radius, execution.level);
  build_lists(
      grid.clusters(), execution.threads, lists, [](std::size_t cluster) { return cluster; },
      [&](std::size_t cluster, Scratch& scratch) {
        searcher.find_near_cluster(cluster, scratch, lists.count.data());
      });
}

}  // namespace mallow

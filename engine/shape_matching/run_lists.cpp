#include "shape_matching/run_lists.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

constexpr std::size_t k_max_runs = std::numeric_limits<std::uint32_t>::max();
/// Relative, of squared distances: far above their rounding.
constexpr float k_slack = 1e-5f;
/// Points of a column that are tested at a time, a bit each.
constexpr std::uint32_t k_bits = 64;
/// One of so many blocks is searched to learn how many runs there will be.
constexpr std::size_t k_sampled = 64;

/// Ends of a column's points across, so that lattice lines are searched as the lines they are.
struct ColumnBounds {
  float low[2], high[2];
};

/// A column near that of the points that are searched for, and what of it was in reach of the last of them.
struct Near {
  std::uint32_t start, end;  ///< its sorted points
  std::uint32_t low, high;   ///< those in reach
  ColumnBounds bounds;
};

/// Where a block of points keeps what it finds until it has a place in the lists.
struct Scratch {
  std::vector<Near> near;
  std::vector<Run> runs;
  std::vector<std::uint32_t> rows;
};

float gap(float low, float high, float value) {
  return value < low ? low - value : value > high ? value - high : 0.0f;
}

struct Search {
  const ColumnOrder& columns;
  float squared_radius;
  float slack;  ///< of squared distances, for what is only narrowed down [m²]
  int reach[2];
  std::vector<ColumnBounds> bounds;
  const float* along;
  const float* across[2];

  Search(const ColumnOrder& order, float radius, int threads)
      : columns(order),
        squared_radius(radius * radius),
        slack(k_slack * squared_radius),
        bounds(order.columns()) {
    along = order.sorted.axis(static_cast<std::size_t>(order.along));
    for (std::size_t k = 0; k < 2; ++k) {
      across[k] = order.sorted.axis(static_cast<std::size_t>(order.across[k]));
      // Two more than fit into the radius: for the part of a column, and for rounding.
      reach[k] =
          static_cast<int>(std::min(static_cast<float>(order.dims[k]), radius * order.inverse_width + 2.0f));
    }
    parallel_for(threads, bounds.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c)
        for (std::size_t k = 0; k < 2; ++k) {
          const auto [low, high] =
              std::minmax_element(across[k] + order.start[c], across[k] + order.start[c + 1]);
          if (order.start[c] == order.start[c + 1]) continue;
          bounds[c].low[k] = *low;
          bounds[c].high[k] = *high;
        }
    });
  }

  /// Columns with points within the radius of a column, in the order of their points.
  void find_near(std::size_t column, float first_along, std::vector<Near>& near) const {
    near.clear();
    const auto in_strip = static_cast<int>(column % ColumnOrder::k_strip);
    const std::size_t row = column / ColumnOrder::k_strip;
    const int b = static_cast<int>(row % static_cast<std::size_t>(columns.dims[1]));
    const int a =
        static_cast<int>(row / static_cast<std::size_t>(columns.dims[1])) * ColumnOrder::k_strip + in_strip;
    const int a0 = std::max(0, a - reach[0]), a1 = std::min(columns.dims[0] - 1, a + reach[0]);
    const int b0 = std::max(0, b - reach[1]), b1 = std::min(columns.dims[1] - 1, b + reach[1]);
    const ColumnBounds& mine = bounds[column];
    for (int strip = a0; strip <= a1; strip = (strip / ColumnOrder::k_strip + 1) * ColumnOrder::k_strip) {
      const int strip_end = std::min(a1, (strip / ColumnOrder::k_strip + 1) * ColumnOrder::k_strip - 1);
      for (int nb = b0; nb <= b1; ++nb)
        for (int na = strip; na <= strip_end; ++na) {
          const std::size_t c = columns.column(na, nb);
          const std::uint32_t start = columns.start[c], end = columns.start[c + 1];
          if (start == end) continue;
          float squared = 0;
          for (std::size_t k = 0; k < 2; ++k) {
            const float g =
                std::max({0.0f, bounds[c].low[k] - mine.high[k], mine.low[k] - bounds[c].high[k]});
            squared += g * g;
          }
          if (squared > squared_radius + slack) continue;
          const auto at =
              static_cast<std::uint32_t>(std::lower_bound(along + start, along + end, first_along) - along);
          near.push_back({start, end, at, at, bounds[c]});
        }
    }
  }

  /// Narrows a column to what can be in reach of a point, and little more: what is in it is tested.
  bool narrow(float x, float a, float b, Near& n) const {
    const float ga = gap(n.bounds.low[0], n.bounds.high[0], a),
                gb = gap(n.bounds.low[1], n.bounds.high[1], b);
    const float squared = squared_radius - (ga * ga + gb * gb);
    if (squared < -slack) return false;
    const float chord = std::sqrt(squared + 2 * slack);
    // Differences as the test takes them: rounded, they are in the order of the points.
    while (n.low > n.start && along[n.low - 1] - x >= -chord) --n.low;
    while (n.low < n.end && along[n.low] - x < -chord) ++n.low;
    n.high = std::max(n.high, n.low);
    while (n.high > n.low && along[n.high - 1] - x > chord) --n.high;
    while (n.high < n.end && along[n.high] - x <= chord) ++n.high;
    return true;
  }

  /// Appends the runs of sorted places within the radius of point s; returns how many places they hold.
  std::uint32_t search(std::size_t s, std::vector<Near>& near, std::vector<Run>& runs) const {
    const float x = along[s], a = across[0][s], b = across[1][s];
    const auto inside = [&](std::uint32_t k) {
      const float dx = along[k] - x, da = across[0][k] - a, db = across[1][k] - b;
      return (dx * dx + da * da) + db * db <= squared_radius;
    };
    Run run{0, 0};
    std::uint32_t members = 0;
    const auto add = [&](std::uint32_t first, std::uint32_t count) {
      if (run.first + run.count == first) {
        run.count += count;
      } else {
        if (run.count > 0) runs.push_back(run);
        run = {first, count};
      }
      members += count;
    };
    for (Near& n : near) {
      if (!narrow(x, a, b, n)) continue;
      // Bits first, then their runs: whether a point is inside is not to be predicted.
      for (std::uint32_t first = n.low; first < n.high; first += k_bits) {
        const std::uint32_t count = std::min(k_bits, n.high - first);
        std::uint64_t bits = 0;
        for (std::uint32_t k = 0; k < count; ++k) bits |= static_cast<std::uint64_t>(inside(first + k)) << k;
        for (std::uint32_t k = 0; bits >> k != 0;) {
          k += static_cast<std::uint32_t>(std::countr_zero(bits >> k));
          const auto length = static_cast<std::uint32_t>(std::countr_one(bits >> k));
          add(first + k, length);
          k += length;
          if (k == k_bits) break;
        }
      }
    }
    if (run.count > 0) runs.push_back(run);
    return members;
  }

  /// Replaces the runs from `from` on, of sorted places, by those of the rows that are there.
  void to_rows(std::size_t from, Scratch& scratch) const {
    std::vector<std::uint32_t>& rows = scratch.rows;
    rows.clear();
    for (std::size_t r = from; r < scratch.runs.size(); ++r)
      for (std::uint32_t k = 0; k < scratch.runs[r].count; ++k)
        rows.push_back(columns.order[scratch.runs[r].first + k]);
    std::sort(rows.begin(), rows.end());
    scratch.runs.resize(from);
    for (const std::uint32_t row : rows) {
      if (scratch.runs.size() > from && scratch.runs.back().first + scratch.runs.back().count == row)
        ++scratch.runs.back().count;
      else
        scratch.runs.push_back({row, 1});
    }
  }

  /// Lists of the sorted points [begin, end), their places counted from 0.
  void search_block(std::size_t begin, std::size_t end, Scratch& scratch, RunLists& lists) const {
    scratch.runs.clear();
    const std::uint32_t* const starts = columns.start.data();
    std::size_t column =
        static_cast<std::size_t>(std::upper_bound(starts, starts + columns.start.size(), begin) - starts) - 1;
    for (std::size_t s = begin; s < end; ++column) {
      const std::size_t column_end = std::min<std::size_t>(end, starts[column + 1]);
      if (s < column_end) find_near(column, along[s], scratch.near);
      for (; s < column_end; ++s) {
        const std::size_t from = scratch.runs.size();
        const std::uint32_t members = search(s, scratch.near, scratch.runs);
        if (!columns.already) to_rows(from, scratch);
        const std::uint32_t row = columns.order[s];
        lists.begin[row] = static_cast<std::uint32_t>(from);
        lists.count[row] = static_cast<std::uint32_t>(scratch.runs.size() - from);
        lists.members[row] = members;
      }
    }
  }
};

/// From one of k_sampled blocks, and a tenth more.
std::size_t estimate_runs(const Search& search, int threads, RunLists& lists) {
  const std::size_t n = lists.count.size(), blocks = (n + k_block - 1) / k_block;
  std::atomic<std::size_t> points = 0, runs = 0;
  parallel_for(
      threads, (blocks + k_sampled - 1) / k_sampled,
      [&](std::size_t sample, std::size_t) {
        thread_local Scratch scratch;
        // Not the first: a body's border has fewer.
        const std::size_t block = std::min(blocks - 1, sample * k_sampled + k_sampled / 2);
        const std::size_t begin = block * k_block, end = std::min(n, begin + k_block);
        search.search_block(begin, end, scratch, lists);
        points += end - begin;
        runs += scratch.runs.size();
      },
      1);
  return (runs * n / points) * 11 / 10 + k_block;
}

}  // namespace

void find_runs(const ColumnOrder& columns, float radius, int threads, RunLists& lists) {
  const std::size_t n = columns.order.size();
  lists.begin.resize_unset(n);
  lists.count.resize_unset(n);
  lists.members.resize_unset(n);
  const Search search(columns, radius, threads);
  if (lists.runs.size() < n) lists.runs.resize_unset(estimate_runs(search, threads, lists));
  for (;;) {
    std::atomic<std::size_t> used = 0;
    parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
      thread_local Scratch scratch;
      search.search_block(begin, end, scratch, lists);
      const std::size_t place = used.fetch_add(scratch.runs.size(), std::memory_order_relaxed);
      if (place + scratch.runs.size() > lists.runs.size()) return;
      std::copy(scratch.runs.begin(), scratch.runs.end(), lists.runs.data() + place);
      for (std::size_t s = begin; s < end; ++s)
        lists.begin[columns.order[s]] += static_cast<std::uint32_t>(place);
    });
    if (used > k_max_runs)
      throw ConfigError("support_radius", "the regions would need " + std::to_string(used) +
                                              " runs of particles; at most 4294967295 fit: choose a smaller "
                                              "radius");
    if (used <= lists.runs.size()) return;
    lists.runs.resize_unset(used + used / 10);
  }
}

}  // namespace mallow

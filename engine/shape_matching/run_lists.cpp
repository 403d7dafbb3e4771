#include "shape_matching/run_lists.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/bounds.h"
#include "core/parallel.h"
#include "mallow/errors.h"
#include "shape_matching/reach_lanes.h"
#include "shape_matching/run_tables.h"

namespace mallow {
namespace {

constexpr std::size_t k_max_runs = std::numeric_limits<std::uint32_t>::max();
/// Relative, of squared distances: far above their rounding.
constexpr float k_slack = 1e-5f;
/// One of so many blocks is searched to learn how many runs there will be.
constexpr std::size_t k_sampled = 64;

/// Ends of a pillar's points across, so that lattice lines are searched as the lines they are.
struct PillarBounds {
  float low[2], high[2];
};

/// Where a block of points keeps what it finds until it has a place in the lists.
struct Scratch {
  std::vector<ReachPillar> near;
  std::vector<Run> found;
  std::size_t runs = 0;  ///< of `found`, those of the block so far
  std::vector<std::uint32_t> rows;

  /// Room for `count` more runs.
  Run* room(std::size_t count) {
    if (found.size() < runs + count) found.resize(std::max(runs + count, 2 * found.size()));
    return found.data() + runs;
  }
};

/// Of runs that nothing is in twice; returns how many are left.
std::size_t put_in_order(std::span<Run> runs) {
  std::ranges::sort(runs, {}, &Run::first);
  std::size_t last = 0;
  for (std::size_t r = 1; r < runs.size(); ++r) {
    if (runs[last].first + runs[last].count == runs[r].first)
      runs[last].count += runs[r].count;
    else
      runs[++last] = runs[r];
  }
  return last + 1;
}

struct Search {
  const PillarOrder& pillars;
  const ReachLanes& lanes;
  ReachInput input;
  const FormerLists* former;
  float slack;       ///< of squared distances, for what is only narrowed down [m²]
  float news_reach;  ///< of what came, rounding included [m]
  int reach[2];
  std::vector<PillarBounds> bounds;
  bool in_order = false;             ///< all former points are still there, one behind the other as before
  std::vector<std::uint8_t> broken;  ///< per row, of former ones in order: a run of its list is two now

  Search(const PillarOrder& order, float radius, const Execution& execution, const FormerLists* known)
      : pillars(order),
        lanes(MALLOW_SELECT(execution.level, reach_lanes)),
        input{order.sorted.axis(static_cast<std::size_t>(order.along)), {}, radius * radius},
        former(known),
        slack(k_slack * input.squared_radius),
        news_reach(radius * (1 + k_slack)),
        bounds(order.pillars()) {
    for (std::size_t k = 0; k < 2; ++k) {
      input.across[k] = order.sorted.axis(static_cast<std::size_t>(order.across[k]));
      // Two more than fit into the radius: for the part of a pillar, and for rounding.
      reach[k] =
          static_cast<int>(std::min(static_cast<float>(order.dims[k]), radius * order.inverse_width + 2.0f));
    }
    if (former) find_broken();
    parallel_for(execution.threads, bounds.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c)
        for (std::size_t k = 0; k < 2; ++k) {
          const auto [low, high] =
              std::minmax_element(input.across[k] + order.start[c], input.across[k] + order.start[c + 1]);
          if (order.start[c] == order.start[c + 1]) continue;
          bounds[c].low[k] = *low;
          bounds[c].high[k] = *high;
        }
    });
  }

  /// Pillars with points within the radius of a pillar, in the order of their points, and from what is in
  /// reach of its point s on; returns how many points they hold.
  std::size_t find_near(std::size_t pillar, std::size_t s, std::vector<ReachPillar>& near) const {
    near.clear();
    std::size_t points = 0;
    const auto in_strip = static_cast<int>(pillar % PillarOrder::k_strip);
    const std::size_t row = pillar / PillarOrder::k_strip;
    const int b = static_cast<int>(row % static_cast<std::size_t>(pillars.dims[1]));
    const int a =
        static_cast<int>(row / static_cast<std::size_t>(pillars.dims[1])) * PillarOrder::k_strip + in_strip;
    const int a0 = std::max(0, a - reach[0]), a1 = std::min(pillars.dims[0] - 1, a + reach[0]);
    const int b0 = std::max(0, b - reach[1]), b1 = std::min(pillars.dims[1] - 1, b + reach[1]);
    const PillarBounds& mine = bounds[pillar];
    for (int strip = a0; strip <= a1; strip = (strip / PillarOrder::k_strip + 1) * PillarOrder::k_strip) {
      const int strip_end = std::min(a1, (strip / PillarOrder::k_strip + 1) * PillarOrder::k_strip - 1);
      for (int nb = b0; nb <= b1; ++nb)
        for (int na = strip; na <= strip_end; ++na) {
          const std::size_t c = pillars.pillar(na, nb);
          const std::uint32_t start = pillars.start[c], end = pillars.start[c + 1];
          if (start == end) continue;
          float squared = 0;
          for (std::size_t k = 0; k < 2; ++k) {
            const float g =
                std::max({0.0f, bounds[c].low[k] - mine.high[k], mine.low[k] - bounds[c].high[k]});
            squared += g * g;
          }
          const float squared_chord = input.squared_radius - squared;
          if (squared_chord < -slack) continue;
          const float chord = std::sqrt(squared_chord + 2 * slack), x = input.along[s];
          const float* const first =
              std::lower_bound(input.along + start, input.along + end, -chord,
                               [x](float place, float least) { return place - x < least; });
          near.push_back({static_cast<std::uint32_t>(first - input.along), end, chord});
          points += end - start;
        }
    }
    return points;
  }

  /// Replaces the runs from `from` on, of sorted places, by those of the rows that are there.
  void to_rows(std::size_t from, Scratch& scratch) const {
    std::vector<std::uint32_t>& rows = scratch.rows;
    rows.clear();
    for (std::size_t r = from; r < scratch.runs; ++r)
      for (std::uint32_t k = 0; k < scratch.found[r].count; ++k)
        rows.push_back(pillars.order[scratch.found[r].first + k]);
    std::sort(rows.begin(), rows.end());
    scratch.runs = from;
    Run* const runs = scratch.room(rows.size());
    std::size_t count = 0;
    for (const std::uint32_t row : rows) {
      if (count > 0 && runs[count - 1].first + runs[count - 1].count == row)
        ++runs[count - 1].count;
      else
        runs[count++] = {row, 1};
    }
    scratch.runs += count;
  }

  /// What came between two rows broke the runs of those lists that have both. A point is in the lists of
  /// those that are in its own, so two lists name them all.
  void find_broken() {
    const std::span<const Run> now = former->now;
    in_order = std::ranges::all_of(now, [](const Run& run) { return run.count > 0; }) &&
               std::ranges::is_sorted(now, {}, &Run::first);
    if (!in_order) return;
    broken.assign(former->former.size(), 0);
    std::vector<std::uint32_t> has_first(now.size(), 0);
    for (std::uint32_t r = 0; r + 1 < now.size(); ++r) {
      if (now[r].count > 1) continue;
      const auto visit = [&](std::uint32_t list, const auto& each) {
        former->lists.for_each_whole_run(list, [&](std::uint32_t first, std::uint32_t count) {
          for (std::uint32_t k = first; k < first + count; ++k) each(k);
        });
      };
      visit(r, [&](std::uint32_t k) { has_first[k] = r + 1; });
      visit(r + 1, [&](std::uint32_t k) {
        if (has_first[k] == r + 1) broken[now[k].first] = 1;
      });
    }
  }

  /// Whether the former list of a row has its runs still, in their order and apart from each other. members:
  /// becomes how many rows there are in it.
  bool keeps_runs(std::uint32_t row, std::uint32_t& members) const {
    if (in_order) {
      members = static_cast<std::uint32_t>(std::lround(1 / former->weight[former->former[row]]));
      return broken[row] == 0;
    }
    bool same = true;
    std::uint32_t behind = 0;  // the last run and the row that would be part of it
    members = 0;
    former->lists.for_each_whole_run(former->former[row], [&](std::uint32_t first, std::uint32_t count) {
      const Run& moved = former->now[first];
      same = same && moved.count >= count && (members == 0 || behind < moved.first);
      behind = moved.first + count;
      members += count;
    });
    return same;
  }

  /// Appends the former list of a row: those of it that are still there, by their rows. Returns how many.
  std::uint32_t take_former(std::uint32_t row, Scratch& scratch, Kept& kept) const {
    const TableLists& lists = former->lists;
    const std::uint32_t list = former->former[row];
    Run* const runs = scratch.room(lists.count[list] * lists.lengths.length[lists.lengths.count - 1]);
    std::uint32_t count = 0, members = 0;
    bool ascending = true, whole = true;
    lists.for_each_whole_run(list, [&](std::uint32_t first, std::uint32_t rows) {
      for (std::uint32_t r = first; r < first + rows;) {
        const Run now{former->now[r].first, std::min(former->now[r].count, first + rows - r)};
        r += std::max(now.count, 1u);
        members += now.count;
        whole = whole && now.count > 0;
        if (count > 0 && runs[count - 1].first + runs[count - 1].count == now.first) {
          runs[count - 1].count += now.count;
        } else if (now.count > 0) {
          ascending = ascending && (count == 0 || runs[count - 1].first < now.first);
          runs[count++] = now;
        }
      }
    });
    scratch.runs += ascending ? count : put_in_order({runs, count});
    kept = whole ? Kept::points : Kept::none;
    return members;
  }

  /// Lists of the sorted points [begin, end), their places counted from 0.
  void search_block(std::size_t begin, std::size_t end, Scratch& scratch, RunLists& lists) const {
    scratch.runs = 0;
    const std::uint32_t* const starts = pillars.start.data();
    std::size_t pillar =
        static_cast<std::size_t>(std::upper_bound(starts, starts + pillars.start.size(), begin) - starts) - 1;
    for (std::size_t s = begin; s < end; ++pillar) {
      const std::size_t pillar_end = std::min<std::size_t>(end, starts[pillar + 1]);
      std::size_t most_runs = 0;
      for (; s < pillar_end; ++s) {
        const std::size_t from = scratch.runs;
        const std::uint32_t row = pillars.order[s];
        if (former && !is_near(pillars.sorted.get(s), former->news, news_reach)) {
          if (keeps_runs(row, lists.members[row]))
            lists.kept[row] = Kept::runs;
          else
            lists.members[row] = take_former(row, scratch, lists.kept[row]);
        } else {
          if (former) lists.kept[row] = Kept::none;
          // Of a pillar every other point at the most begins a run.
          if (most_runs == 0) most_runs = (find_near(pillar, s, scratch.near) + scratch.near.size()) / 2 + 1;
          scratch.runs += lanes.runs_in_reach(input, s, scratch.near.data(), scratch.near.size(),
                                              scratch.room(most_runs), lists.members[row]);
          if (!pillars.already) to_rows(from, scratch);
        }
        lists.begin[row] = static_cast<std::uint32_t>(from);
        lists.count[row] = static_cast<std::uint32_t>(scratch.runs - from);
      }
    }
  }
};

/// From one of k_sampled blocks, and a tenth more.
std::size_t estimate_runs(const Search& search, const Threads& threads, RunLists& lists) {
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
        runs += scratch.runs;
      },
      1);
  return (runs * n / points) * 11 / 10 + k_block;
}

}  // namespace

void find_runs(const PillarOrder& pillars, float radius, const Execution& execution, RunLists& lists,
               const FormerLists* former) {
  const std::size_t n = pillars.order.size();
  lists.begin.resize_unset(n);
  lists.count.resize_unset(n);
  lists.members.resize_unset(n);
  lists.kept.resize_unset(former ? n : 0);
  const Search search(pillars, radius, execution, former);
  if (!former && lists.runs.size() < n)
    lists.runs.resize_unset(estimate_runs(search, execution.threads, lists));
  for (;;) {
    std::atomic<std::size_t> used = 0;
    parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
      thread_local Scratch scratch;
      search.search_block(begin, end, scratch, lists);
      const std::size_t place = used.fetch_add(scratch.runs, std::memory_order_relaxed);
      if (place + scratch.runs > lists.runs.size()) return;
      std::copy_n(scratch.found.data(), scratch.runs, lists.runs.data() + place);
      for (std::size_t s = begin; s < end; ++s)
        lists.begin[pillars.order[s]] += static_cast<std::uint32_t>(place);
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

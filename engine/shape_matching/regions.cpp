#include "shape_matching/regions.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "shape_matching/moment_lanes.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

/// Largest trace of a region's moments, in W |c̄|², that rounding alone can leave where all its particles are
/// at one place.
constexpr double k_no_extent = 1e-13;

/// Width of pillars: the spacing of the particles, or of as many spread evenly over their bounds.
float pillar_width(const ShapeMatching& shape) {
  if (shape.spacing > 0) return shape.spacing;
  const VectorColumn& x = shape.reference;
  double volume = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::minmax_element(x.axis(a), x.axis(a) + x.size());
    volume *= std::max(static_cast<double>(*high) - static_cast<double>(*low),
                       static_cast<double>(shape.region_radius));
  }
  return static_cast<float>(std::cbrt(volume / static_cast<double>(x.size())));
}

/// 32 well-mixed bits of a number (Mueller's integer hash).
std::uint32_t scattered(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x45d9f3bu;
  x = (x ^ (x >> 16)) * 0x45d9f3bu;
  return x ^ (x >> 16);
}

bool any_drawn(std::span<const Run> runs, std::uint32_t stride) {
  for (const Run& run : runs)
    for (std::uint32_t k = 0; k < run.count; ++k)
      if (is_drawn(run.first + k, stride)) return true;
  return false;
}

/// The particles that own regions, and how many regions those before each particle own.
void choose_owners(std::uint32_t stride, const Threads& threads, RegionScratch& scratch) {
  const std::size_t n = scratch.near.count.size();
  Column<std::uint32_t>& first_region = scratch.first_region;
  first_region.resize_unset(n + 1);
  scratch.block_begin.resize((n + k_block - 1) / k_block);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    std::uint32_t owners = 0;
    for (std::size_t i = begin; i < end; ++i) {
      first_region[i] = owners;
      // i is in j's region where j is in i's list. A drawn i is in its own.
      owners += is_drawn(static_cast<std::uint32_t>(i), stride) || !any_drawn(scratch.near.of(i), stride);
    }
    scratch.block_begin[begin / k_block] = owners;
  });
  std::uint32_t total = 0;
  for (std::uint32_t& block : scratch.block_begin) {
    const std::uint32_t owners = block;
    block = total;
    total += owners;
  }
  first_region[n] = total;
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) first_region[i] += scratch.block_begin[begin / k_block];
  });
  scratch.owners.resize_unset(total);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (first_region[i] < first_region[i + 1])
        scratch.owners[first_region[i]] = static_cast<std::uint32_t>(i);
  });
}

/// Turns the lists of near particles into those of the regions that they own: what is consecutive stays so.
/// Reads and writes each list in its place.
void turn_around(const Threads& threads, RegionScratch& scratch) {
  RunLists& lists = scratch.near;
  const Column<std::uint32_t>& first_region = scratch.first_region;
  parallel_for(threads, lists.count.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Run* const runs = lists.runs.data() + lists.begin[i];
      std::uint32_t count = 0;
      for (std::uint32_t r = 0; r < lists.count[i]; ++r) {
        const std::uint32_t from = first_region[runs[r].first],
                            to = first_region[runs[r].first + runs[r].count];
        if (from == to) continue;
        if (count > 0 && runs[count - 1].first + runs[count - 1].count == from)
          runs[count - 1].count += to - from;
        else
          runs[count++] = {from, to - from};
      }
      lists.count[i] = count;
    }
  });
}

/// w_i, from how many regions a particle is in; Σ |N_i| of all particles, whatever the stride.
std::size_t weigh_particles(bool every, const Threads& threads, RegionScratch& scratch,
                            ShapeMatching& shape) {
  const RunLists& near = scratch.near;
  return parallel_reduce(
      threads, near.count.size(), scratch.partial_count, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
          std::uint32_t memberships = every ? near.members[i] : 0;
          if (!every)
            for (const Run& run : near.of(i))
              memberships += scratch.first_region[run.first + run.count] - scratch.first_region[run.first];
          shape.weight[i] = 1.0f / static_cast<float>(memberships);
          sum += near.members[i];
        }
        return sum;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

/// Marks the regions to measure: those with other runs than before, and those of what is in more or fewer
/// regions than before and weighs otherwise. Marks none where most lists are others.
void find_changed(RegionScratch& scratch) {
  const RunLists& near = scratch.near;
  const std::size_t n = near.kept.size();
  scratch.changed.resize(0);
  if (2 * static_cast<std::size_t>(std::ranges::count(near.kept, Kept::none)) >= n) return;
  scratch.changed.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (near.kept[i] != Kept::runs) scratch.changed[i] = 1;
    if (near.kept[i] != Kept::none) continue;
    for (const Run& run : near.of(i)) std::fill_n(scratch.changed.data() + run.first, run.count, 1);
  }
}

/// W_j, c̄_j and B_j of the regions that are still there, to the rows that they have now.
void carry_measures(std::span<const Run> now, std::size_t regions, RegionScratch& scratch,
                    ShapeMatching& shape) {
  const auto carry = [&](const float* from, float* to) {
    for (std::size_t r = 0; r < now.size(); r += std::max(now[r].count, 1u))
      std::copy_n(from + r, now[r].count, to + (now[r].count > 0 ? now[r].first : 0));
  };
  const auto carry_column = [&](Column<float>& column) {
    scratch.carried.resize_unset(regions);
    carry(column.data(), scratch.carried.data());
    column.swap(scratch.carried);
  };
  carry_column(shape.region_weight);
  for (Column<float>& column : shape.moment) carry_column(column);
  scratch.carried_center.resize_unset(regions);
  for (std::size_t a = 0; a < 3; ++a) carry(shape.center.axis(a), scratch.carried_center.axis(a));
  shape.center.swap(scratch.carried_center);
}

/// W_j, c̄_j and B_j of the regions [begin, end), but for those that did not change.
void measure_regions(std::size_t begin, std::size_t end, const MomentLanes& lanes, const double* moment_rows,
                     const RegionScratch& scratch, ShapeMatching& shape) {
  std::vector<Run> kept;
  const auto runs_of = [&](std::size_t j) -> std::span<const Run> {
    const RunLists& near = scratch.near;
    if (near.kept.empty() || near.kept[j] != Kept::runs)
      return near.of(scratch.owners.empty() ? j : scratch.owners[j]);
    kept.clear();
    shape.regions.for_each_whole_run(j, [&](std::uint32_t first, std::uint32_t count) {
      kept.push_back({first, count});
    });
    return kept;
  };
  for (std::size_t j = begin; j < end; ++j) {
    if (!scratch.changed.empty() && scratch.changed[j] == 0) continue;
    double s[k_moment_row];
    const std::span<const Run> runs = runs_of(j);
    lanes.sum_runs(moment_rows, runs.data(), runs.size(), s);
    const double weight = s[0];
    // In double, what cancels here is less than what the single precision of positions has lost.
    const Eigen::Vector3d center = Eigen::Vector3d(s[1], s[2], s[3]) / weight;
    double moment[6] = {s[4] - weight * center[0] * center[0], s[5] - weight * center[1] * center[1],
                        s[6] - weight * center[2] * center[2], s[7] - weight * center[1] * center[2],
                        s[8] - weight * center[0] * center[2], s[9] - weight * center[0] * center[1]};
    if (moment[0] + moment[1] + moment[2] < k_no_extent * weight * center.squaredNorm())
      std::fill_n(moment, 6, 0.0);
    shape.region_weight[j] = static_cast<float>(weight);
    shape.center.set(j, center.cast<float>());
    for (std::size_t k = 0; k < 6; ++k) shape.moment[k][j] = static_cast<float>(moment[k]);
  }
}

/// Room for the sums of n particles and of regions, whose rotations start from none.
void make_room(std::size_t n, std::size_t regions, const Threads& threads, ShapeMatching& shape) {
  for (Column<float>& column : shape.rotation) column.resize_unset(regions);
  // Also the padding, where a zero quaternion would have no direction.
  parallel_for(threads, padded(regions), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = 0; k < 4; ++k)
      std::fill(shape.rotation[k].data() + begin, shape.rotation[k].data() + end, k == 3 ? 1.0f : 0.0f);
  });
  // Behind the last row rows of zeros, for runs that would reach beyond it.
  shape.sums.resize_unset((regions + k_longest_run) * k_row);
  std::fill(shape.sums.data() + regions * k_row, shape.sums.end(), 0.0f);
  shape.undecided.resize_unset(regions);
  reset_stretches(shape);
  const std::size_t of_regions = shape.by_particle().lengths.count;
  shape.table.resize_unset(
      std::max(n * shape.regions.lengths.count, of_regions > 1 ? regions * of_regions : 0) * k_row);
  shape.pull.resize_unset(n);
}

}  // namespace

bool is_drawn(std::uint32_t row, std::uint32_t stride) {
  return row % stride == scattered(row / stride) % stride;
}

std::size_t ShapeMatching::bytes() const {
  std::size_t sum = reference.bytes() + regions.bytes() + memberships.bytes() + weight.bytes() +
                    region_weight.bytes() + center.bytes() + table.bytes() + sums.bytes() +
                    undecided.bytes() + plastic.bytes() + pull.bytes() + elasticity.bytes() + owners.bytes() +
                    parts.of.capacity() * sizeof(std::uint32_t);
  for (const Column<float>& column : moment) sum += column.bytes();
  for (const Column<float>& column : rotation) sum += column.bytes();
  return sum;
}

void update_reference(const VectorColumn& positions, std::size_t begin, std::size_t end,
                      const Threads& threads, RegionScratch& scratch, ShapeMatching& shape) {
  const std::size_t n = end - begin;
  using Sums = std::array<double, 3>;
  const auto add = [](Sums a, const Sums& b) {
    for (std::size_t k = 0; k < 3; ++k) a[k] += b[k];
    return a;
  };
  Sums mean = parallel_reduce(
      threads, n, scratch.partial_sums, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums sum{};
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t i = begin + first; i < begin + last; ++i)
            sum[a] += static_cast<double>(positions.axis(a)[i]);
        return sum;
      },
      add);
  for (double& m : mean) m /= static_cast<double>(n);
  shape.reference.resize_unset(n);
  const Sums squares = parallel_reduce(
      threads, n, scratch.partial_sums, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums sum{};
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t i = first; i < last; ++i) {
            const double x = static_cast<double>(positions.axis(a)[begin + i]) - mean[a];
            sum[a] += x * x;
            shape.reference.axis(a)[i] = static_cast<float>(x);
          }
        return sum;
      },
      add);
  shape.total_moment = (squares[0] + squares[1] + squares[2]) / static_cast<double>(n);
  shape.mean.setZero();
  shape.frame = {};
  shape.built = false;
}

void sort_reference(const Execution& execution, PillarOrder& pillars, ShapeMatching& shape) {
  order_by_pillars(shape.reference, 0, shape.reference.size(), pillar_width(shape), execution, pillars);
  shape.reference.swap(pillars.sorted);
}

void list_regions(const Execution& execution, RegionScratch& scratch, ShapeMatching& shape,
                  const FormerLists* former) {
  const std::size_t n = shape.reference.size();
  const bool every = shape.region_stride == 1;
  shape.parts = {};
  order_by_pillars(shape.reference, 0, n, pillar_width(shape), execution, scratch.pillars);
  // With a larger stride owners are drawn by row, and only their lists are there.
  find_runs(scratch.pillars, shape.region_radius, execution, scratch.near, every ? former : nullptr);
  scratch.owners.resize(0);
  if (!every) choose_owners(static_cast<std::uint32_t>(shape.region_stride), execution.threads, scratch);
  shape.owners.resize_unset(scratch.owners.size());
  std::copy(scratch.owners.begin(), scratch.owners.end(), shape.owners.begin());
  encode(scratch.near, scratch.owners.span(), n, execution.threads, shape.regions, every ? former : nullptr);
  shape.weight.resize_unset(n);
  shape.average_neighbors =
      static_cast<double>(weigh_particles(every, execution.threads, scratch, shape)) / static_cast<double>(n);
}

void measure_regions(const Execution& execution, RegionScratch& scratch, ShapeMatching& shape,
                     const FormerLists* former) {
  const std::size_t n = shape.reference.size(), regions = shape.regions.count.size();
  const MomentLanes& lanes = MALLOW_SELECT(execution.level, moment_lanes);
  // The table is not in use yet, and lends its memory.
  shape.table.resize_unset(std::max(shape.table.size(), n * k_moment_row * sizeof(double) / sizeof(float)));
  auto* const moment_rows = reinterpret_cast<double*>(shape.table.data());
  parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
    lanes.write_rows(raw(std::as_const(shape.reference)), shape.weight.data(), begin, end, moment_rows);
  });
  find_changed(scratch);
  if (!scratch.changed.empty()) {
    carry_measures(former->now, regions, scratch, shape);
  } else {
    shape.region_weight.resize_unset(regions);
    shape.center.resize_unset(regions);
    for (Column<float>& column : shape.moment) column.resize_unset(regions);
  }
  parallel_for(execution.threads, regions, [&](std::size_t begin, std::size_t end) {
    measure_regions(begin, end, lanes, moment_rows, scratch, shape);
  });
}

void build_regions(const Execution& execution, RegionScratch& scratch, ShapeMatching& shape,
                   const FormerLists* former) {
  list_regions(execution, scratch, shape, former);
  measure_regions(execution, scratch, shape, former);
  const std::size_t regions = shape.region_weight.size();
  if (shape.region_stride > 1) {
    turn_around(execution.threads, scratch);
    encode(scratch.near, {}, regions, execution.threads, shape.memberships);
  }
  make_room(shape.reference.size(), regions, execution.threads, shape);
  shape.built = true;
}

}  // namespace mallow

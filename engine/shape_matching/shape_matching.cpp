#include "shape_matching/shape_matching.h"

#include <limits>

#include "core/parallel.h"
#include "core/polar_rotation.h"
#include "shape_matching/moment_lanes.h"

namespace mallow {
namespace {

/// Tables up to this size are left to the caches [bytes]: fetching ahead costs a tenth there, and saves a
/// quarter where a table of 200 MB is swept.
constexpr std::size_t k_near_caches = std::size_t{8} << 20;

RegionLists raw(const TableLists& lists) {
  return {lists.begin.data(), lists.count.data(), lists.entries.data(),
          lists.rows * lists.lengths.count * k_row * sizeof(float) > k_near_caches};
}

using Block = RangeBlocks::Block;
using FrameSums = std::array<double, 12>;

FrameSums sum_frame(const VectorColumn& positions, const MatchedBodies::Body& body, const Block& block,
                    InstructionLevel level) {
  const Eigen::Vector3d near_origin = positions.get(body.begin).cast<double>();
  FrameSums sums;
  MALLOW_SELECT(level, moment_lanes)
      .frame_sums({positions.x() + body.begin, positions.y() + body.begin, positions.z() + body.begin},
                  raw(std::as_const(body.shape->reference)), near_origin.data(), block.begin, block.end,
                  sums.data());
  return sums;
}

/// Any frame near the body's motion does; the best one leaves the smallest u.
void update_frame(const VectorColumn& positions, std::size_t begin, std::span<const FrameSums> partial,
                  ShapeMatching& shape) {
  FrameSums sums{};
  for (const FrameSums& block : partial)
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += block[k];
  const double count = static_cast<double>(shape.reference.size());
  const Eigen::Vector3d mean = Eigen::Vector3d(sums[9], sums[10], sums[11]) / count;
  Eigen::Matrix3d a;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      a(i, j) = sums[static_cast<std::size_t>(3 * i + j)] / count - mean[i] * shape.mean[j];
  shape.frame.rotation = polar_rotation(a, shape.frame.rotation, shape.total_moment);
  shape.frame.translation = positions.get(begin).cast<double>() + mean - shape.frame.rotation * shape.mean;
}

/// The few regions that Newton's method leaves: singular, mirrored, or turned too far.
void solve_undecided(const ShapeInput& in, std::size_t begin, std::size_t end, ShapeMatching& shape) {
  const std::uint8_t* const open = shape.undecided.data();
  for (std::size_t j = begin;; ++j) {
    j = static_cast<std::size_t>(std::find(open + j, open + end, 1) - open);
    if (j == end) return;
    const double scale = static_cast<double>(shape.moment[0][j] + shape.moment[1][j] + shape.moment[2][j]);
    const std::optional<Eigen::Quaterniond> rotation = solve_exactly(j, scale, shape);
    if (!rotation) continue;
    float* const row = shape.sums.data() + j * k_row;
    const Eigen::Matrix3d r = rotation->toRotationMatrix();
    const Vec3 center = shape.center.get(j);
    const float weight = shape.region_weight[j];
    for (int i = 0; i < 3; ++i) {
      Vec3 difference;
      for (int k = 0; k < 3; ++k) {
        difference[k] = static_cast<float>(r(i, k) - static_cast<double>(in.frame_rotation[3 * i + k]));
        row[3 * i + k] = difference[k];
      }
      row[9 + i] = row[9 + i] / weight + (weight - weight) - difference.dot(center);
    }
    if (in.elasticity)
      for (std::size_t k = 0; k < k_row_sums; ++k) row[k] *= in.elasticity[j];
  }
}

/// The rows of a block of particles and the sums of their runs: a block computes the rows behind it that its
/// runs reach once more, rather than wait for them.
void write_particle_table(const ShapeInput& in, const Block& block, const ShapeLanes& lanes,
                          ShapeMatching& shape) {
  const std::size_t n = shape.reference.size(), first = block.begin, last = block.end;
  const RunLengths& lengths = shape.regions.lengths;
  float* const table = shape.table.data() + first * k_row;
  if (lengths.count == 1) {
    lanes.write_rows(in, first, last, table);
    return;
  }
  alignas(64) float rows[(k_block + k_longest_run) * k_row];
  const std::size_t reach = last + lengths.length[lengths.count - 1] - 1, end = std::min(n, reach);
  lanes.write_rows(in, first, end, rows);
  std::fill(rows + (end - first) * k_row, rows + (reach - first) * k_row, 0.0f);
  lanes.sum_runs(rows, last - first, lengths, n, table);
}

void solve_block(int iterations, const Block& block, InstructionLevel level, float time_step,
                 const MatchedBodies::Body& body) {
  ShapeMatching& shape = *body.shape;
  if (shape.flows) return solve_plastic_regions(body, block.begin, block.end, iterations, level, time_step);
  float* const rotation[4] = {shape.rotation[0].data(), shape.rotation[1].data(), shape.rotation[2].data(),
                              shape.rotation[3].data()};
  MALLOW_SELECT(level, rotation_lanes)
      .solve(body.input, block.begin, block.end, iterations, shape.sums.data(), rotation,
             shape.undecided.data());
  solve_undecided(body.input, block.begin, block.end, shape);
}

bool has_region_table(const ShapeMatching& shape) {
  return shape.by_particle().lengths.count > 1;
}

void write_region_table(const Block& block, const ShapeLanes& lanes, ShapeMatching& shape) {
  if (!has_region_table(shape)) return;
  lanes.sum_runs(shape.sums.data() + block.begin * k_row, block.end - block.begin,
                 shape.by_particle().lengths, shape.region_weight.size(),
                 shape.table.data() + block.begin * k_row);
}

void write_goals(const ShapeInput& in, const Block& block, const ShapeLanes& lanes, ShapeMatching& shape) {
  const float* const table = has_region_table(shape) ? shape.table.data() : shape.sums.data();
  lanes.goals(in, block.begin, block.end, table, raw(shape.pull));
}

/// Bodies that one thread handles at a time where each takes some microseconds.
constexpr std::size_t k_body_block = 8;

}  // namespace

std::optional<Eigen::Quaterniond> solve_exactly(std::size_t region, double scale, ShapeMatching& shape) {
  float* const row = shape.sums.data() + region * k_row;
  Eigen::Matrix3d a;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) a(i, k) = static_cast<double>(row[3 * i + k]);
  const auto q = [&](std::size_t k) { return static_cast<double>(shape.rotation[k][region]); };
  const Eigen::Quaterniond last(q(3), q(0), q(1), q(2));
  if (!a.allFinite() || !last.coeffs().allFinite()) {
    row[9] = std::numeric_limits<float>::quiet_NaN();
    return {};
  }
  const Eigen::Quaterniond rotation = polar_rotation(a, last.normalized(), scale);
  for (std::size_t k = 0; k < 4; ++k)
    shape.rotation[k][region] = static_cast<float>(rotation.coeffs()[static_cast<Eigen::Index>(k)]);
  return rotation;
}

ShapeInput shape_input(const VectorColumn& positions, std::size_t begin, const ShapeMatching& shape) {
  ShapeInput in{
      .regions = raw(shape.regions),
      .memberships = raw(shape.by_particle()),
      .position = {positions.x() + begin, positions.y() + begin, positions.z() + begin},
      .reference = raw(shape.reference),
      .weight = shape.weight.data(),
      .region_weight = shape.region_weight.data(),
      .center = raw(shape.center),
      .moment = {},
      .elasticity = shape.elasticity.empty() ? nullptr : shape.elasticity.data(),
      .frame_rotation = {},
      .frame_translation = {},
  };
  for (std::size_t k = 0; k < 6; ++k) in.moment[k] = shape.moment[k].data();
  const Eigen::Matrix3d rotation = shape.frame.rotation.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    in.frame_translation[i] = static_cast<float>(shape.frame.translation[i]);
    for (int j = 0; j < 3; ++j) in.frame_rotation[3 * i + j] = static_cast<float>(rotation(i, j));
  }
  return in;
}

void MatchedBodies::clear() {
  small.clear();
  large.clear();
  particles.clear();
  regions.clear();
  time_step = 0;
}

void MatchedBodies::add(ShapeMatching& shape, std::size_t begin, const FlowRule& rule) {
  const std::size_t rows = shape.reference.size(), owned = shape.region_weight.size();
  if (rows <= k_block) {
    small.push_back({&shape, begin, rule});
    return;
  }
  large.push_back({&shape, begin, rule});
  particles.add(rows);
  regions.add(owned);
}

void match_small_bodies(const VectorColumn& positions, int iterations, const Execution& execution,
                        MatchedBodies& matched) {
  const ShapeLanes& lanes = MALLOW_SELECT(execution.level, shape_lanes);
  const auto match = [&](MatchedBodies::Body& body) {
    ShapeMatching& shape = *body.shape;
    const Block particles{0, 0, static_cast<std::uint32_t>(shape.reference.size())};
    const Block regions{0, 0, static_cast<std::uint32_t>(shape.region_weight.size())};
    const FrameSums sums = sum_frame(positions, body, particles, execution.level);
    update_frame(positions, body.begin, {&sums, 1}, shape);
    body.input = shape_input(positions, body.begin, shape);
    write_particle_table(body.input, particles, lanes, shape);
    lanes.sum_regions(body.input, regions.begin, regions.end, shape.table.data(), shape.sums.data());
    solve_block(iterations, regions, execution.level, matched.time_step, body);
    write_region_table(regions, lanes, shape);
    write_goals(body.input, particles, lanes, shape);
  };
  parallel_for(
      execution.threads, matched.small.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) match(matched.small[b]);
      },
      k_body_block);
}

void sum_regions(const VectorColumn& positions, const Execution& execution, MatchedBodies& matched) {
  const ShapeLanes& lanes = MALLOW_SELECT(execution.level, shape_lanes);
  matched.partial.resize(matched.particles.blocks.size());
  parallel_for(execution.threads, matched.particles, [&](const Block& block, std::size_t number) {
    matched.partial[number] = sum_frame(positions, matched.large[block.range], block, execution.level);
  });
  parallel_for(
      execution.threads, matched.large.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          MatchedBodies::Body& body = matched.large[b];
          const std::uint32_t first = matched.particles.first[b], last = matched.particles.first[b + 1];
          update_frame(positions, body.begin, std::span(matched.partial).subspan(first, last - first),
                       *body.shape);
          body.input = shape_input(positions, body.begin, *body.shape);
        }
      },
      k_body_block);
  parallel_for(execution.threads, matched.particles, [&](const Block& block, std::size_t) {
    const MatchedBodies::Body& body = matched.large[block.range];
    write_particle_table(body.input, block, lanes, *body.shape);
  });
  parallel_for(execution.threads, matched.regions, [&](const Block& block, std::size_t) {
    const MatchedBodies::Body& body = matched.large[block.range];
    lanes.sum_regions(body.input, block.begin, block.end, body.shape->table.data(), body.shape->sums.data());
  });
}

void solve_rotations(int iterations, const Execution& execution, MatchedBodies& matched) {
  parallel_for(execution.threads, matched.regions, [&](const Block& block, std::size_t) {
    solve_block(iterations, block, execution.level, matched.time_step, matched.large[block.range]);
  });
}

void compute_goals(const Execution& execution, MatchedBodies& matched) {
  const ShapeLanes& lanes = MALLOW_SELECT(execution.level, shape_lanes);
  parallel_for(execution.threads, matched.regions, [&](const Block& block, std::size_t) {
    write_region_table(block, lanes, *matched.large[block.range].shape);
  });
  parallel_for(execution.threads, matched.particles, [&](const Block& block, std::size_t) {
    const MatchedBodies::Body& body = matched.large[block.range];
    write_goals(body.input, block, lanes, *body.shape);
  });
}

void match_shapes(const VectorColumn& positions, int iterations, const Execution& execution,
                  MatchedBodies& matched) {
  match_small_bodies(positions, iterations, execution, matched);
  sum_regions(positions, execution, matched);
  solve_rotations(iterations, execution, matched);
  compute_goals(execution, matched);
}

}  // namespace mallow

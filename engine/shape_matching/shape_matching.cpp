#include "shape_matching/shape_matching.h"

#include <limits>

#include "core/parallel.h"
#include "core/polar_rotation.h"
#include "shape_matching/moment_kernels.h"

namespace mallow {
namespace {

/// Tables up to this size are left to the caches [bytes]: fetching ahead costs a tenth there, and saves a
/// quarter where a table of 200 MB is swept.
constexpr std::size_t k_near_caches = std::size_t{8} << 20;

RegionLists raw(const TableLists& lists) {
  return {lists.begin.data(), lists.count.data(), lists.entries.data(),
          lists.rows * lists.lengths.levels * k_row * sizeof(float) > k_near_caches};
}

ShapeInput input(const VectorColumn& positions, std::size_t begin, const ShapeMatching& shape) {
  ShapeInput in{
      .regions = raw(shape.regions),
      .memberships = raw(shape.by_particle()),
      .position = {positions.x() + begin, positions.y() + begin, positions.z() + begin},
      .reference = raw(shape.reference),
      .weight = shape.weight.data(),
      .region_weight = shape.region_weight.data(),
      .center = raw(shape.center),
      .moment = {},
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

/// Any frame near the group's motion does; the best one leaves the smallest u.
void update_frame(const VectorColumn& positions, std::size_t begin, const Threads& threads,
                  InstructionLevel level, ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  const Eigen::Vector3d near_origin = positions.get(begin).cast<double>();
  const MomentKernels& kernels = MALLOW_SELECT(level, moment_kernels);
  using Sums = std::array<double, 12>;
  const Sums sums = parallel_reduce(
      threads, n, shape.partial, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums s;
        kernels.frame_sums({positions.x() + begin, positions.y() + begin, positions.z() + begin},
                           raw(std::as_const(shape.reference)), near_origin.data(), first, last, s.data());
        return s;
      },
      [](Sums a, const Sums& b) {
        for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
        return a;
      });
  const double count = static_cast<double>(n);
  Eigen::Matrix3d a;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) a(i, j) = sums[static_cast<std::size_t>(3 * i + j)] / count;
  shape.frame.rotation = polar_rotation(a, shape.frame.rotation, shape.total_moment);
  // The reference is centred, so its mean needs no turning.
  shape.frame.translation = near_origin + Eigen::Vector3d(sums[9], sums[10], sums[11]) / count;
}

/// The few regions that Newton's method leaves: singular, mirrored, or turned too far.
void solve_undecided(const ShapeInput& in, std::size_t begin, std::size_t end, ShapeMatching& shape) {
  for (std::size_t j = begin; j < end; ++j) {
    if (!shape.undecided[j]) continue;
    float* const row = shape.sums.data() + j * k_row;
    Eigen::Matrix3d a;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) a(i, k) = static_cast<double>(row[3 * i + k]);
    const Eigen::Quaterniond last(
        static_cast<double>(shape.rotation[3][j]), static_cast<double>(shape.rotation[0][j]),
        static_cast<double>(shape.rotation[1][j]), static_cast<double>(shape.rotation[2][j]));
    const double scale = static_cast<double>(shape.moment[0][j] + shape.moment[1][j] + shape.moment[2][j]);
    if (!a.allFinite() || !last.coeffs().allFinite()) {
      // The rotation stays, for a later step; the goals show that this one has none.
      row[9] = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    const Eigen::Quaterniond rotation = polar_rotation(a, last.normalized(), scale);
    for (std::size_t k = 0; k < 4; ++k)
      shape.rotation[k][j] = static_cast<float>(rotation.coeffs()[static_cast<Eigen::Index>(k)]);
    const Eigen::Matrix3d r = rotation.toRotationMatrix();
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
  }
}

/// The rows of the particles and the sums of their runs, block by block: a block computes the rows behind it
/// that its runs reach once more, rather than wait for them.
void write_particle_table(const ShapeInput& in, const Threads& threads, const ShapeKernels& kernels,
                          ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  const RunLengths& lengths = shape.regions.lengths;
  parallel_for(threads, n, [&](std::size_t first, std::size_t last) {
    float* const table = shape.table.data() + first * k_row;
    if (lengths.levels == 1) {
      kernels.write_rows(in, first, last, table);
      return;
    }
    alignas(64) float rows[(k_block + k_longest_run) * k_row];
    const std::size_t reach = last + lengths.length[lengths.levels - 1] - 1, end = std::min(n, reach);
    kernels.write_rows(in, first, end, rows);
    std::fill(rows + (end - first) * k_row, rows + (reach - first) * k_row, 0.0f);
    kernels.sum_runs(rows, last - first, lengths, n, table);
  });
}

}  // namespace

void sum_regions(const VectorColumn& positions, std::size_t begin, const Threads& threads,
                 InstructionLevel level, ShapeMatching& shape) {
  update_frame(positions, begin, threads, level, shape);
  const ShapeInput in = input(positions, begin, shape);
  const ShapeKernels& kernels = MALLOW_SELECT(level, shape_kernels);
  write_particle_table(in, threads, kernels, shape);
  parallel_for(threads, shape.region_weight.size(), [&](std::size_t first, std::size_t last) {
    kernels.sum_regions(in, first, last, shape.table.data(), shape.sums.data());
  });
}

void solve_rotations(const VectorColumn& positions, std::size_t begin, int iterations, const Threads& threads,
                     InstructionLevel level, ShapeMatching& shape) {
  const ShapeInput in = input(positions, begin, shape);
  const RotationKernels& kernels = MALLOW_SELECT(level, rotation_kernels);
  float* const rotation[4] = {shape.rotation[0].data(), shape.rotation[1].data(), shape.rotation[2].data(),
                              shape.rotation[3].data()};
  parallel_for(threads, shape.region_weight.size(), [&](std::size_t first, std::size_t last) {
    kernels.solve(in, first, last, iterations, shape.sums.data(), rotation, shape.undecided.data());
    solve_undecided(in, first, last, shape);
  });
}

void compute_goals(const VectorColumn& positions, std::size_t begin, const Threads& threads,
                   InstructionLevel level, ShapeMatching& shape) {
  const ShapeInput in = input(positions, begin, shape);
  const ShapeKernels& kernels = MALLOW_SELECT(level, shape_kernels);
  const RunLengths& lengths = shape.by_particle().lengths;
  const float* table = shape.sums.data();
  if (lengths.levels > 1) {
    const std::size_t regions = shape.region_weight.size();
    parallel_for(threads, regions, [&](std::size_t first, std::size_t last) {
      kernels.sum_runs(shape.sums.data() + first * k_row, last - first, lengths, regions,
                       shape.table.data() + first * k_row);
    });
    table = shape.table.data();
  }
  parallel_for(threads, shape.reference.size(), [&](std::size_t first, std::size_t last) {
    kernels.goals(in, first, last, table, raw(shape.pull));
  });
}

}  // namespace mallow

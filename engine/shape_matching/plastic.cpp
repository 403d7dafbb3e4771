#include "shape_matching/plastic.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/bounds.h"
#include "core/execution.h"
#include "core/parallel.h"
#include "neighbors/neighbor_lists.h"
#include "shape_matching/plastic_lanes.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

/// How far the elastic strain of a region may be from none to survive a new frame whole. [model 2, section 5]
constexpr double k_least_strain = 0.8, k_most_strain = 1.25;
/// The same of its size: where the model has 0.8, a body that a blow has crushed when a check comes would
/// stay as small.
constexpr double k_least_size = 0.3, k_most_size = 1.25;

/// Whether all eigenvalues of a symmetric matrix are above 0.
bool is_definite(const Eigen::Matrix3d& m) {
  return m(0, 0) > 0 && m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0) > 0 && m.determinant() > 0;
}

double bounded_size(double determinant) {
  return std::clamp(std::cbrt(determinant), k_least_size, k_most_size);
}

/// Whether none of a strain's eigenvalues is beyond what survives, which most are not: then nobody asks what
/// they are.
bool survives_whole(const Eigen::Matrix3d& strain) {
  if (!is_definite(strain)) return false;
  const Eigen::Matrix3d size = bounded_size(strain.determinant()) * Eigen::Matrix3d::Identity();
  return is_definite(strain - k_least_strain * size) && is_definite(k_most_strain * size - strain);
}

/// The matrix in front of a sums row.
Eigen::Matrix3d front_matrix(const ShapeMatching& shape, std::size_t region) {
  const float* const row = shape.sums.data() + region * k_row;
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(row).cast<double>();
}

Eigen::Matrix3d rotation_of(const ShapeMatching& shape, std::size_t region) {
  const auto q = [&](std::size_t k) { return static_cast<double>(shape.rotation[k][region]); };
  return Eigen::Quaterniond(q(3), q(0), q(1), q(2)).toRotationMatrix();
}

/// Particles that have flowed by more than `least`, by where they are and where they rest.
void gather_flowed(const VectorColumn& positions, std::size_t begin, float least, const ShapeMatching& shape,
                   FlowScratch& scratch) {
  list_flowed(least, shape, scratch.which);
  const std::size_t count = scratch.which.size();
  scratch.here.resize_unset(count);
  scratch.rest.resize_unset(count);
  for (std::size_t k = 0; k < count; ++k) {
    scratch.here.set(k, positions.get(begin + scratch.which[k]));
    scratch.rest.set(k, shape.reference.get(scratch.which[k]));
  }
}

/// Whether holds(k) for any k below n.
template <class Holds>
bool any_below(std::size_t n, const Threads& threads, const Holds& holds) {
  std::atomic<bool> any = false;
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end && !any.load(std::memory_order_relaxed); ++k)
      if (holds(k)) any.store(true, std::memory_order_relaxed);
  });
  return any;
}

/// Whether two are nearer than `near` in one place and farther apart than `far` in the other.
bool any_part_ways(const VectorColumn& here, float near, const VectorColumn& there, float far,
                   const Execution& execution, FlowScratch& scratch) {
  if (here.size() < 2) return false;  // a region that has flowed may be the first of no particle
  const CellGrid& grid = scratch.grid;
  build_cell_grid(here, 0, here.size(), near, execution, scratch.grid);
  build_neighbor_lists(grid, near, execution, scratch.lists);
  return any_below(here.size(), execution.threads, [&](std::size_t s) {
    const Vec3 own = there.get(grid.order[s]);
    return std::ranges::any_of(scratch.lists.of(s), [&](std::uint32_t t) {
      return (own - there.get(grid.order[t])).squaredNorm() > far * far;
    });
  });
}

float most_flow(const ShapeMatching& shape) {
  const std::span<const float> flow = shape.plastic.flow.span();
  return flow.empty() ? 0.0f : *std::ranges::max_element(flow);
}

}  // namespace

bool is_torn(const VectorColumn& positions, std::size_t begin, const FrameLimits& limits,
             const Execution& execution, const ShapeMatching& shape, FlowScratch& scratch) {
  const float least = limits.least_flow;
  if (!(most_flow(shape) > least)) return false;
  const float far = (1 + limits.tear_strain) * shape.region_radius;
  if (shape.region_stride != 1) {  // regions are not those of all particles: who is near is searched for
    gather_flowed(positions, begin, least, shape, scratch);
    return any_part_ways(scratch.rest, shape.region_radius, scratch.here, far, execution, scratch);
  }
  const TableLists& lists = shape.regions;
  const float* const flow = shape.plastic.flow.data();
  return any_below(lists.rows, execution.threads, [&](std::size_t j) {
    if (!(flow[j] > least)) return false;
    const Vec3 own = positions.get(begin + j);
    float farthest = 0;
    lists.for_each_run(j, [&](std::size_t first, std::size_t length) {
      for (std::size_t i = std::max(first, j + 1); i < first + length; ++i) {  // a pair is in both lists
        const float square = (own - positions.get(begin + i)).squaredNorm();
        farthest = std::max(farthest, flow[i] > least ? square : 0.0f);
      }
    });
    return farthest > far * far;
  });
}

std::size_t PlasticColumns::bytes() const {
  std::size_t sum = flow.bytes() + yield.bytes();
  for (const Column<float>& column : stretch) sum += column.bytes();
  return sum;
}

CarriedStretch carried_stretch(const PlasticColumns& columns, std::size_t region) {
  CarriedStretch carried{.flow = columns.flow[region]};
  for (int k = 0; k < 9; ++k)
    carried.stretch(k / 3, k % 3) = columns.stretch[static_cast<std::size_t>(k)][region];
  return carried;
}

void set_stretch(const CarriedStretch& carried, std::size_t region, PlasticColumns& columns) {
  columns.flow[region] = carried.flow;
  for (int k = 0; k < 9; ++k)
    columns.stretch[static_cast<std::size_t>(k)][region] = carried.stretch(k / 3, k % 3);
}

void reset_stretches(ShapeMatching& shape) {
  PlasticColumns& columns = shape.plastic;
  if (!shape.flows) {
    columns = {};
    return;
  }
  const std::size_t regions = shape.region_weight.size();
  for (std::size_t k = 0; k < 9; ++k) {
    columns.stretch[k].resize_unset(regions);
    std::ranges::fill(columns.stretch[k].span(), k % 4 == 0 ? 1.0f : 0.0f);
  }
  columns.flow.resize_unset(regions);
  std::ranges::fill(columns.flow.span(), 0.0f);
}

namespace {

/// B of a region.
Eigen::Matrix3d moment_of(const ShapeMatching& shape, std::size_t region) {
  const auto b = [&](std::size_t k) { return static_cast<double>(shape.moment[k][region]); };
  Eigen::Matrix3d moment;
  moment << b(0), b(5), b(4), b(5), b(1), b(3), b(4), b(3), b(2);
  return moment;
}

}  // namespace

Eigen::Matrix3d stretched_moment(const ShapeMatching& shape, std::size_t region) {
  const Eigen::Matrix3d stretch = carried_stretch(shape.plastic, region).stretch.cast<double>();
  return stretch * moment_of(shape, region) * stretch.transpose();
}

bool is_thin(const Eigen::Matrix3d& moment) {
  const double extent = moment.trace() / 3;
  return !(moment.determinant() > static_cast<double>(k_thin) * extent * extent * extent);
}

ReframedRegion reframed_region(const Eigen::Matrix3d& m, const Eigen::Matrix3d& rotation,
                               const Eigen::Matrix3d& moment) {
  const double fit = moment.trace() - 2 * rotation.cwiseProduct(m).sum();
  if (is_thin(moment)) return {.fit = fit};
  const Eigen::Matrix3d f = rotation.transpose() * m * moment.inverse();
  const Eigen::Matrix3d e = 0.5 * (f + f.transpose());
  const auto strain_of = [&](double size) { return (e / size - Eigen::Matrix3d::Identity()).norm(); };
  if (survives_whole(e)) {
    const Eigen::Matrix3d stretch = rotation * e.inverse() * rotation.transpose();
    return {stretch.cast<float>(), strain_of(bounded_size(e.determinant())), fit};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(e);
  const Eigen::Vector3d& found = solver.eigenvalues();
  const double size = found[0] > 0 ? bounded_size(found.prod()) : 1;
  const Eigen::Vector3d strain = size * (found / size).cwiseMax(k_least_strain).cwiseMin(k_most_strain);
  const Eigen::Matrix3d axes = rotation * solver.eigenvectors();
  const Eigen::Matrix3d stretch = axes * strain.cwiseInverse().asDiagonal() * axes.transpose();
  if (!stretch.allFinite()) return {.fit = fit};
  return {stretch.cast<float>(), strain_of(size), fit};
}

void bound_strain(double energy, ShapeMatching& shape) {
  const std::size_t regions = shape.region_weight.size();
  double sum = 0;
  for (std::size_t j = 0; j < regions; ++j) {
    const Eigen::Matrix3d stretch = carried_stretch(shape.plastic, j).stretch.cast<double>();
    const Eigen::Matrix3d away = stretch - Eigen::Matrix3d::Identity();
    sum += 0.5 * (away * moment_of(shape, j) * away.transpose()).trace();
  }
  if (!(sum > energy)) return;
  const float share = static_cast<float>(std::sqrt(energy / sum));
  for (std::size_t j = 0; j < regions; ++j) {
    CarriedStretch carried = carried_stretch(shape.plastic, j);
    carried.stretch = share * carried.stretch + (1 - share) * Eigen::Matrix3f::Identity();
    set_stretch(carried, j, shape.plastic);
  }
}

void list_flowed(float least, const ShapeMatching& shape, Column<std::uint32_t>& which) {
  const std::size_t n = shape.reference.size();
  which.resize_unset(n);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (shape.plastic.flow[shape.first_region(i)] > least) which[count++] = static_cast<std::uint32_t>(i);
  which.resize(count);
}

bool reframe_is_due(const VectorColumn& positions, std::size_t begin, const FrameLimits& limits,
                    const Execution& execution, const ShapeMatching& shape, FlowScratch& scratch) {
  const float most = most_flow(shape);
  if (most > k_far_flow) return true;
  if (most <= limits.merge_flow || !(shape.spacing > 0)) return false;
  gather_flowed(positions, begin, limits.merge_flow, shape, scratch);
  return any_part_ways(scratch.here, shape.spacing, scratch.rest, shape.region_radius, execution, scratch);
}

bool has_flowed_too_far(const ShapeMatching& shape) {
  const std::span<const float> flow = shape.plastic.flow.span();
  const auto far = std::ranges::count_if(flow, [](float k) { return k > k_farthest_flow; });
  return 2 * static_cast<std::size_t>(far) > flow.size();
}

bool is_strained_by_a_blow(const std::vector<ReframedRegion>& regions, float yield,
                           const ShapeMatching& shape) {
  const Column<float>& yields = shape.plastic.yield;
  std::size_t strained = 0;
  for (std::size_t j = 0; j < regions.size(); ++j)
    strained += regions[j].strain > std::max(static_cast<double>(k_much_strain),
                                             2.0 * static_cast<double>(yields.empty() ? yield : yields[j]));
  return 2 * strained > regions.size();
}

void solve_plastic_regions(const MatchedBodies::Body& body, std::size_t begin, std::size_t end,
                           int iterations, InstructionLevel level, float time_step) {
  ShapeMatching& shape = *body.shape;
  const PlasticLanes& lanes = MALLOW_SELECT(level, plastic_lanes);
  float* rotation[4];
  float* stretch[9];
  for (std::size_t k = 0; k < 4; ++k) rotation[k] = shape.rotation[k].data();
  for (std::size_t k = 0; k < 9; ++k) stretch[k] = shape.plastic.stretch[k].data();
  // What is beyond yield flows at once where the rate is infinite: then no product with it is taken.
  const float share = !(time_step > 0)              ? 0.0f
                      : std::isinf(body.rule.creep) ? 1.0f
                                                    : -std::expm1(-body.rule.creep * time_step);
  const Column<float>& yields = shape.plastic.yield;
  const FlowInput rule{
      .yield = body.rule.yield, .yields = yields.empty() ? nullptr : yields.data(), .share = share};
  float *const sums = shape.sums.data(), *const flow = shape.plastic.flow.data();
  std::uint8_t* const undecided = shape.undecided.data();
  // Whoever asks for strains reads M, of all of them.
  lanes.solve(body.input, body.reframed ? nullptr : &rule, begin, end, iterations, sums, rotation, stretch,
              flow, undecided);
  for (std::size_t j = begin; j < end; ++j)
    if (undecided[j] == k_open) solve_exactly(j, stretched_moment(shape, j).trace(), shape);
  if (body.reframed)
    for (std::size_t j = begin; j < end; ++j)
      (*body.reframed)[j] =
          reframed_region(front_matrix(shape, j), rotation_of(shape, j), stretched_moment(shape, j));
  lanes.finish(body.input, rule, begin, end, undecided, rotation, sums, stretch, flow);
}

}  // namespace mallow

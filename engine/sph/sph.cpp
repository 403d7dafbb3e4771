#include "sph/sph.h"

#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

SphInput input(const Sph& sph) {
  return {
      .list_begin = sph.lists.begin.data(),
      .list_count = sph.lists.count.data(),
      .indices = sph.lists.indices.data(),
      .row_of = sph.grid.order.data(),
      .group = sph.group.empty() ? nullptr : sph.group.data(),
      .groups = sph.groups.data(),
      .position = raw(sph.grid.sorted),
      .velocity = sph.viscous ? raw(sph.velocity) : ConstVectors{},
      .inverse_radius = 1.0f / sph.support_radius,
      .density_factor = sph.factors.density,
      .spiky_gradient = sph.factors.spiky_gradient,
      .viscosity = sph.factors.viscosity,
      .poly6_gradient = sph.factors.poly6_gradient,
      .poly6_laplacian = sph.factors.poly6_laplacian,
  };
}

/// to[k] = from[order[k]]
void gather(const VectorColumn& from, const Column<std::uint32_t>& order, int threads, VectorColumn& to) {
  parallel_for(threads, order.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a) {
      const float* source = from.axis(a);
      float* target = to.axis(a);
      for (std::size_t k = begin; k < end; ++k) target[k] = source[order[k]];
    }
  });
}

/// No pair has come within σ that was beyond the lists' reach: no particle has moved half the slack since,
/// seen from the mean motion, which changes no distance.
bool lists_hold(const VectorColumn& positions, int threads, Sph& sph) {
  // Share of the reach that rounding may have taken from the distances in single precision that made the
  // lists.
  constexpr double k_rounding = 1e-5;
  const double radius = static_cast<double>(sph.support_radius),
               slack = static_cast<double>(sph.neighbor_slack);
  const double limit = 0.5 * slack * radius - k_rounding * (1 + slack) * radius;
  const std::size_t n = positions.size();
  const auto moved = [&](std::size_t i) -> Eigen::Vector3d {
    return positions.get(i).cast<double>() - sph.listed.get(i).cast<double>();
  };
  const Eigen::Vector3d sum = parallel_reduce(
      threads, n, sph.partial_motion, Eigen::Vector3d(0, 0, 0),
      [&](std::size_t begin, std::size_t end) {
        Eigen::Vector3d block(0, 0, 0);
        for (std::size_t i = begin; i < end; ++i) block += moved(i);
        return block;
      },
      [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) -> Eigen::Vector3d { return a + b; });
  const Eigen::Vector3d mean = sum / static_cast<double>(n);
  const double farthest = parallel_reduce(
      threads, n, sph.partial_distance, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double block = 0;
        for (std::size_t i = begin; i < end; ++i) block = std::max(block, (moved(i) - mean).squaredNorm());
        return block;
      },
      [](double a, double b) { return std::max(a, b); });
  return limit > 0 && farthest < limit * limit;
}

}  // namespace

std::size_t Sph::bytes() const {
  return grid.bytes() + lists.bytes() + listed.bytes() + group.bytes() + velocity.bytes() + density.bytes() +
         pressure.bytes() + volume.bytes() + density_by_row.bytes() + acceleration.bytes() +
         cross_group.bytes();
}

bool find_neighbors(const VectorColumn& positions, int threads, InstructionLevel level, Sph& sph) {
  const std::size_t n = positions.size();
  if (sph.neighbor_slack > 0 && !sph.lists_outdated && lists_hold(positions, threads, sph)) {
    gather(positions, sph.grid.order, threads, sph.grid.sorted);
    return false;
  }
  const float reach = sph.support_radius * (1.0f + sph.neighbor_slack);
  build_cell_grid(positions, 0, n, reach, threads, sph.grid);
  build_neighbor_lists(sph.grid, reach, threads, level, sph.lists);
  sph.lists_outdated = false;
  if (sph.neighbor_slack > 0) {
    sph.listed.resize(n);
    for (std::size_t a = 0; a < 3; ++a) std::copy_n(positions.axis(a), n, sph.listed.axis(a));
  }
  if (sph.groups.size() == 1) return true;
  sph.group.resize(n);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto behind = std::upper_bound(sph.group_end.begin(), sph.group_end.end(), sph.grid.order[i]);
      sph.group[i] = static_cast<std::uint8_t>(behind - sph.group_end.begin());
    }
  });
  return true;
}

void compute_density(int threads, InstructionLevel level, Sph& sph) {
  const std::size_t n = sph.grid.order.size();
  for (Column<float>* column : {&sph.density, &sph.pressure, &sph.volume, &sph.density_by_row})
    column->resize(n);
  const SphInput in = input(sph);
  const SphKernels& kernels = MALLOW_SELECT(level, sph_kernels);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    kernels.density(in, begin, end, sph.density.data(), sph.pressure.data(), sph.volume.data(),
                    sph.density_by_row.data());
  });
}

void compute_accelerations(const VectorColumn& velocities, int threads, InstructionLevel level, Sph& sph) {
  const std::size_t n = sph.grid.order.size();
  sph.acceleration.resize(n);
  if (sph.groups.size() > 1) sph.cross_group.resize(n);
  if (sph.viscous) {
    sph.velocity.resize(n);
    gather(velocities, sph.grid.order, threads, sph.velocity);
  }
  const SphInput in = input(sph);
  const SphKernels& kernels = MALLOW_SELECT(level, sph_kernels);
  const auto run = sph.formulation == Formulation::printed ? kernels.printed : kernels.conservative;
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    run(in, begin, end, sph.density.data(), sph.pressure.data(), sph.volume.data(), raw(sph.acceleration),
        raw(sph.cross_group));
  });
}

}  // namespace mallow

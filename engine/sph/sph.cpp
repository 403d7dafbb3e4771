#include "sph/sph.h"

#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

SphInput input(const Sph& sph) {
  return {
      .lists = view(sph.grid, sph.lists),
      .group = sph.group.empty() ? nullptr : sph.group.data(),
      .groups = sph.groups.data(),
      .apart = sph.apart,
      .kernel = sph.kernel,
      .wall_share = sph.walls.any ? sph.walls.share.data() : nullptr,
      .position = raw(sph.grid.sorted),
      .velocity = sph.viscous ? raw(sph.velocity) : ConstVectors{},
      .alpha = sph.alpha.empty() ? nullptr : sph.alpha.data(),
      .viscosity = sph.viscosity.empty() ? nullptr : sph.viscosity.data(),
      .radius = sph.support_radius,
      .inverse_radius = 1.0f / sph.support_radius,
      .density_factor = sph.factors.density,
      .spiky_gradient = sph.factors.spiky_gradient,
      .poly6_gradient = sph.factors.poly6_gradient,
  };
}

}  // namespace

std::size_t Sph::bytes() const {
  return grid.bytes() + lists.bytes() + kept.bytes() + rows.bytes() + positions.bytes() + group.bytes() +
         velocity.bytes() + alpha.bytes() + viscosity.bytes() + density.bytes() + pressure.bytes() +
         volume.bytes() + density_by_row.bytes() + acceleration.bytes() + cross_group.bytes() + walls.bytes();
}

bool find_neighbors(const VectorColumn& positions, const Execution& execution, Sph& sph) {
  sph.store_rows = positions.size();
  const bool all = sph.rows.empty();
  const std::size_t n = all ? positions.size() : sph.rows.size();
  const bool keeps = all && sph.neighbor_slack > 0;
  if (keeps &&
      keep_lists(positions, sph.support_radius, sph.neighbor_slack, execution.threads, sph.grid, sph.kept))
    return false;
  const float radius = sph.support_radius * (1.0f + sph.neighbor_slack);
  if (!all) {
    sph.kept.forget();
    sph.positions.resize_unset(n);
    for (std::size_t k = 0; k < n; ++k) sph.positions.set(k, positions.get(sph.rows[k]));
  }
  build_cell_grid(all ? positions : sph.positions, 0, n, radius, execution, sph.grid);
  if (!all)
    for (std::uint32_t& row : sph.grid.order) row = sph.rows[row];
  build_cluster_lists(sph.grid, radius, execution, sph.lists);
  if (keeps) remember_search(sph.grid, sph.kept);
  if (sph.groups.size() == 1) {
    sph.group.resize(0);  // bodies may have gone since there were more
    return true;
  }
  sph.group.resize(n);
  parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      sph.group[i] =
          std::ranges::upper_bound(sph.bodies, std::size_t{sph.grid.order[i]}, {}, &Sph::Body::end)->group;
    }
  });
  return true;
}

void compute_density(const Execution& execution, Sph& sph) {
  const std::size_t n = sph.grid.order.size();
  for (Column<float>* column : {&sph.density, &sph.pressure, &sph.volume}) column->resize(n);
  sph.density_by_row.resize(sph.store_rows);
  const SphInput in = input(sph);
  const SphLanes& lanes = MALLOW_SELECT_NATIVE(execution.level, sph.native, sph_lanes);
  // Lists that are kept for steps to come stay as they are.
  const bool whole = sph.kept.any || sph.keeps_lists;
  const NearLists near =
      whole ? NearLists{nullptr, nullptr} : NearLists{sph.lists.indices.data(), sph.lists.count.data()};
  parallel_for(
      execution.threads, sph.grid.clusters(),
      [&](std::size_t begin, std::size_t end) {
        lanes.density(in, begin, end, near, sph.density.data(), sph.pressure.data(), sph.volume.data(),
                      sph.density_by_row.data());
      },
      k_cluster_block);
}

void gather_sorted(const VectorColumn& by_row, const Sph& sph, const Execution& execution,
                   VectorColumn& sorted) {
  const std::size_t n = sph.grid.order.size();
  sorted.resize(n);
  parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a) {
      const float* from = by_row.axis(a);
      float* to = sorted.axis(a);
      for (std::size_t i = begin; i < end; ++i) to[i] = from[sph.grid.order[i]];
    }
  });
}

void compute_accelerations(const VectorColumn& velocities, const ByParticle& own, const Execution& execution,
                           Sph& sph) {
  const std::size_t n = sph.grid.order.size();
  sph.acceleration.resize(sph.store_rows);
  if (sph.groups.size() > 1 && !sph.apart) sph.cross_group.resize(sph.store_rows);
  if (sph.viscous) gather_sorted(velocities, sph, execution, sph.velocity);
  const auto sort = [&](const Column<float>& by_row, Column<float>& sorted) {
    sorted.resize(by_row.empty() ? 0 : n);
    if (by_row.empty()) return;
    parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) sorted[i] = by_row[sph.grid.order[i]];
    });
  };
  sort(own.alpha, sph.alpha);
  sort(own.viscosity, sph.viscosity);
  const SphInput in = input(sph);
  const SphLanes& lanes = MALLOW_SELECT_NATIVE(execution.level, sph.native, sph_lanes);
  const auto accelerate = sph.formulation == Formulation::printed ? lanes.printed : lanes.conservative;
  parallel_for(
      execution.threads, sph.grid.clusters(),
      [&](std::size_t begin, std::size_t end) {
        accelerate(in, begin, end, sph.density.data(), sph.pressure.data(), sph.volume.data(),
                   raw(sph.acceleration), raw(sph.cross_group));
      },
      k_cluster_block);
}

}  // namespace mallow

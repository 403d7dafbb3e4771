#include "sph/volume.h"

#include <algorithm>
#include <numbers>

#include "core/parallel.h"

namespace mallow {
namespace {

/// λ of what is behind a wall is that of the particle before it: both push.
constexpr float k_mirrored = 2;

/// D is at least this share of that in the lattice: what has few neighbours would be thrown off.
constexpr double k_least_response = 0.5;

VolumeInput input(const Sph& sph, const Volume& volume, float time_step) {
  const bool walls = volume.wall_gradient.size() > 0;
  return {
      .lists = view(sph.grid, sph.lists),
      .group = sph.group.empty() ? nullptr : sph.group.data(),
      .groups = volume.groups.data(),
      .apart = sph.apart,
      .mobile = volume.mobile.empty() ? nullptr : volume.mobile.data(),
      .density = sph.density.data(),
      .position = raw(sph.grid.sorted),
      .velocity = raw(volume.velocity),
      .wall_gradient = walls ? raw(volume.wall_gradient) : ConstVectors{},
      .wall_rate = walls ? volume.wall_rate.data() : nullptr,
      .wall_share = walls ? sph.walls.share.data() : nullptr,
      .inverse_radius = 1.0f / sph.support_radius,
      .time_step = time_step,
  };
}

/// Calls body(wall) for every wall of every particle; those of a row are in one block.
template <class AnyWalls, class Body>
void for_each_wall(AnyWalls& walls, const Execution& execution, const Body& body) {
  parallel_for(execution.threads, walls.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    for (auto& wall : walls.walls[number]) body(wall, walls.bodies[block.range], number);
  });
}

void begin_walls(const Sph& sph, const Execution& execution, Volume& volume) {
  const std::size_t rows = sph.walls.any ? sph.store_rows : 0;
  volume.wall_gradient.resize(0);  // so that all is zero again
  volume.wall_rate.resize(0);
  volume.multiplier_by_row.resize(rows);
  volume.wall_gradient.resize(rows);
  volume.wall_rate.resize(rows);
  volume.changes.resize(rows);
  if (rows == 0) return;
  for_each_wall(sph.walls, execution, [&](const Walls::Wall& wall, const WalledBody&, std::size_t) {
    volume.wall_gradient.set(wall.row, volume.wall_gradient.get(wall.row) - wall.slope * wall.normal);
  });
}

/// dS/dt of the walls that colliders with these velocities are.
void find_wall_rates(const VolumeStep& step, const VectorColumn& velocity, const Sph& sph,
                     const Execution& execution, Volume& volume) {
  for_each_wall(sph.walls, execution, [&](const Walls::Wall& wall, const WalledBody&, std::size_t) {
    volume.wall_rate[wall.row] = 0;
  });
  for_each_wall(sph.walls, execution, [&](const Walls::Wall& wall, const WalledBody&, std::size_t) {
    const Vec3 u = velocity_at(step.colliders[wall.collider].surface, step.position.get(wall.row));
    volume.wall_rate[wall.row] -= wall.slope * (velocity.get(wall.row) - u).dot(wall.normal);
  });
}

/// λ is in sorted order: by row only where there are walls.
void push_by_walls(const VolumeStep& step, Sph& sph, const Execution& execution, Volume& volume,
                   VectorColumn& velocity) {
  parallel_for(execution.threads, sph.grid.order.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      volume.multiplier_by_row[sph.grid.order[i]] = volume.multiplier[i];
  });
  for_each_wall(sph.walls, execution, [&](Walls::Wall& wall, const WalledBody& body, std::size_t block) {
    const std::uint32_t row = wall.row;
    if (step.pin && step.pin[row] != 0) return;
    const float across = k_mirrored * volume.multiplier_by_row[row] * wall.slope / body.mass;
    const Vec3 along = pushed_along(wall, step.alpha ? step.alpha[row] : body.alpha, sph.walls.share[row],
                                    volume.changes.get(row), step.time_step * step.gravity);
    const Vec3 change = across * wall.normal + along;
    wall.across += across / step.time_step;
    velocity.set(row, velocity.get(row) + change);
    if (volume.wall_loads.empty()) return;
    add_load(body.mass, change, step.position.get(row), step.colliders[wall.collider],
             volume.wall_loads[block * step.colliders.size() + wall.collider]);
  });
}

}  // namespace

std::size_t Volume::bytes() const {
  return velocity.bytes() + response.bytes() + multiplier.bytes() + mobile.bytes() + wall_gradient.bytes() +
         wall_rate.bytes() + multiplier_by_row.bytes() + changes.bytes() + contacted.bytes();
}

VolumeGroup volume_group(const SphGroup& group, float spacing, float support_radius) {
  const double radius = static_cast<double>(support_radius), square = radius * radius;
  // Powers of σ are taken out in double, as those of KernelFactors.
  const double weight = 315 / (64 * std::numbers::pi * square * radius);
  const double slope = 20 * weight / square * static_cast<double>(group.kernel_volume);
  const double squares = wendland_lattice_squares(radius, static_cast<double>(spacing));
  return {.slope = static_cast<float>(slope),
          .inverse_mass = 1 / group.mass,
          .inverse_rest_density = 1 / group.rest_density,
          .relaxation = 0,
          .least_response = static_cast<float>(k_least_response * slope * slope * squares /
                                               static_cast<double>(group.mass))};
}

void begin_volume(const VolumeStep& step, const Sph& sph, const Execution& execution, Volume& volume) {
  const std::size_t n = sph.grid.order.size();
  volume.response.resize(n);
  volume.multiplier.resize(n);
  volume.mobile.resize(step.pin ? n : 0);
  parallel_for(execution.threads, volume.mobile.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      volume.mobile[i] = step.pin[sph.grid.order[i]] != 0 ? 0.0f : 1.0f;
  });
  begin_walls(sph, execution, volume);
  volume.wall_loads.assign(sph.walls.any ? sph.walls.partial_loads.size() : 0, {});
}

Compression find_compression(const VolumeStep& step, const VectorColumn& velocity, bool first, const Sph& sph,
                             const Execution& execution, Volume& volume) {
  gather_sorted(velocity, sph, execution, volume.velocity);
  if (sph.walls.any) find_wall_rates(step, velocity, sph, execution, volume);
  const VolumeInput in = input(sph, volume, step.time_step);
  const VolumeLanes& lanes = MALLOW_SELECT_NATIVE(execution.level, sph.native, volume_lanes);
  const std::size_t clusters = sph.grid.clusters();
  volume.partial.assign((clusters + k_cluster_block - 1) / k_cluster_block, {});
  parallel_for(
      execution.threads, clusters,
      [&](std::size_t begin, std::size_t end) {
        volume.partial[begin / k_cluster_block] =
            lanes.compressions(in, begin, end, first, volume.response.data(), volume.multiplier.data());
      },
      k_cluster_block);
  Compression all;
  for (const CompressionSum& part : volume.partial) {
    all.mean += part.sum;
    all.largest = std::max(all.largest, static_cast<double>(part.largest));
  }
  if (!sph.grid.order.empty()) all.mean /= static_cast<double>(sph.grid.order.size());
  return all;
}

void correct_velocities(const VolumeStep& step, Sph& sph, const Execution& execution, Volume& volume,
                        VectorColumn& velocity) {
  const VolumeInput in = input(sph, volume, step.time_step);
  const VolumeLanes& lanes = MALLOW_SELECT_NATIVE(execution.level, sph.native, volume_lanes);
  const Vectors changes = sph.walls.any ? raw(volume.changes) : Vectors{};
  parallel_for(
      execution.threads, sph.grid.clusters(),
      [&](std::size_t begin, std::size_t end) {
        lanes.push(in, begin, end, volume.multiplier.data(), raw(velocity), changes);
      },
      k_cluster_block);
  if (sph.walls.any) push_by_walls(step, sph, execution, volume, velocity);
}

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>

#include "core/isa.h"
#include "core/raw_columns.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// The kernel of one particle, w(|G (x_i − x)|) with a symmetric G; lengths in kernel radii.
struct Ellipsoid {
  float xx, xy, xz, yy, yz, zz;  ///< G
  float weight;                  ///< density in its middle, relative to that inside of a body
  float reach[3];                ///< half of the box it fills
};

/// Sums over the particles about a point: Σ w, Σ w (x_i − x) and Σ w |x_i − x|².
inline constexpr std::size_t k_sums = 5;
/// Share by which reaches, or their squares, grow, so that rounding leaves out no particle that adds
/// something: one may look farther away from a box than from its points.
inline constexpr float k_reach_rounding = 1e-5f;
/// Density and its gradient at a point.
inline constexpr std::size_t k_density_sums = 4;

/// Points of a block that are `step` voxels apart along each axis, from its first voxel on, z fastest.
struct PointLattice {
  int step;     ///< 1, 2 or 4
  float voxel;  ///< its side [kernel radii]

  int side() const { return k_block_side / step; }
  std::size_t count() const { return static_cast<std::size_t>(side() * side() * side()); }
};

/// The box of a block's voxels, and how lengths become kernel radii.
struct BlockBox {
  float low[3], high[3];  ///< [m]
  float squared_reach;    ///< of the particles, and what coordinates may be off by [m²]
  double corner[3];       ///< the first voxel [m]
  double per_radius;      ///< [1/m]
};

/// Particles near a block [kernel radii, from its first voxel], followed by k_cluster that are far from it.
struct NearColumns {
  ConstVectors positions;
  std::size_t count;
  std::uint32_t* listed;  ///< for lanes to note numbers of particles in: k_lists times room()

  static constexpr std::size_t k_lists = 4;
  static constexpr float k_far = 1e9f;  ///< where no kernel reaches, and squares are finite
  std::size_t room() const { return count + k_cluster; }
};

/// Sums over particles at the points of a block. They are taken in the order of the particles, at each group
/// of points over those in its reach: the others would add 0, so that sums have the same bits as over all.
/// Sums of n points are arrays of n.
struct SumLanes {
  /// Of particles at `positions` [m] those within reach of a block, in order; returns how many. near: where
  /// they are, as NearColumns has them; which: their numbers. All arrays: room for `count` + k_cluster.
  std::size_t (*pick_near)(const BlockBox&, ConstVectors positions, std::size_t count, Vectors near,
                           std::uint32_t* which) noexcept;
  /// k_sums of each point.
  void (*sum)(const PointLattice&, const NearColumns&, float* sums) noexcept;
  /// The squared distance to the nearest particle, cut at `farthest`, about 1.
  void (*nearest)(const PointLattice&, const NearColumns&, float farthest, float* squares) noexcept;
  /// Σ weight (1 − |G d|²)³ over particles with kernels of their own, and its gradient: k_density_sums of
  /// each point. reach: of the kernels, by particle.
  void (*density)(const PointLattice&, const NearColumns&, const Ellipsoid* shapes, ConstVectors reach,
                  float* sums) noexcept;
  /// Σ w value / Σ w at points that come in eights, for three values a particle; zero where there is no
  /// particle.
  void (*mean)(ConstVectors points, std::size_t n, const NearColumns&, ConstVectors values,
               Vectors means) noexcept;
};
MALLOW_DECLARE_LEVELS(SumLanes, sum_lanes)
/// Those of best_instruction_level().
const SumLanes& best_sum_lanes();

}  // namespace mallow

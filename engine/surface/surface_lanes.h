#pragma once

#include <cstddef>
#include <cstdint>

#include "core/isa.h"
#include "core/raw_columns.h"
#include "surface/sum_lanes.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// Share of the variance that is too much for one part of a body, see SurfaceShape::spread, in the squared
/// distance.
inline constexpr float k_excess_share = 0.5f;

/// What shapes the surface. Lengths in kernel radii. Fullness is Σ w relative to that inside of a body, at
/// most 1/2.
struct SurfaceShape {
  float voxel_size;
  float offset;  ///< from x̄ to the surface where there is little weight: radius of a lone particle's sphere
  float extra_offset;  ///< added to it at fullness 1/2, a flat face of a body, where x̄ lies deeper
  float spread;        ///< variance of the x_i about x̄ that is taken for one part of a body at fullness 0
  float extra_spread;  ///< added to it at fullness 1/2
  float full_weight;   ///< Σ w in the middle of a body
  float least_weight;  ///< Σ w below this is no part of a body
  float threshold;     ///< fourth root of the density at the surface, where kernels are anisotropic
  float background;    ///< distances are cut here [voxels]
};

/// Σ w, Σ w d and Σ w d dᵀ (xx xy xz yy yz zz) of d = x_i − x.
inline constexpr std::size_t k_moments = 10;
/// Nodes along a side of what a block's sums are interpolated from.
inline constexpr std::size_t k_nodes = 5;

/// Cubic interpolation along one axis between nodes `step` voxels apart, 2 or 4. w[v][n]: share of node n in
/// voxel v, which is 0 but for four of them; voxels that are nodes have but their own.
struct NodeWeights {
  int step;
  float w[k_block_side][k_nodes];
};

/// Where the sums at a block's 5 × 5 × 5 nodes lie, x slowest: of each row along z the first four follow each
/// other. Sums of a node lie `stride` floats apart.
struct NodeRows {
  const float* four[k_nodes * k_nodes];
  const float* fifth[k_nodes * k_nodes];
  std::size_t stride;
};

/// Points come in eights. Sums of n points are arrays of n, as SumLanes has them.
struct SurfaceLanes {
  /// Signed distances [voxels] from sums.
  void (*distances)(const SurfaceShape&, const float* sums, std::size_t n, float* distances) noexcept;
  /// Of n distances, up to 512, a bit each: which are at least `far`, and which at most `deep`.
  void (*find_sides)(const float* distances, std::size_t n, float far, float deep, std::uint64_t* outside,
                     std::uint64_t* inside) noexcept;
  /// Distances of a block's voxels, z fastest, from the sums at its nodes: sums are interpolated, as they are
  /// smooth where distances have creases.
  void (*fill_block)(const SurfaceShape&, const NodeWeights&, const NodeRows&, float* distances) noexcept;
  /// Distances to the nearest of the spheres of radius `offset` around the particles [voxels], cut at the
  /// background, from the squared distances to their middles.
  void (*sphere_distances)(const SurfaceShape&, const float* squares, std::size_t n,
                           float* distances) noexcept;
  /// Moments with w = 1 − |d|³, n of each. Points and particles: three arrays [kernel radii].
  void (*moments_at_points)(ConstVectors points, std::size_t n, ConstVectors particles, std::size_t count,
                            float* moments) noexcept;
  /// Signed distances [voxels] from the surface where the density is at its threshold, to first order.
  void (*density_distances)(const SurfaceShape&, const float* sums, std::size_t n, float* distances) noexcept;
};
MALLOW_DECLARE_LEVELS(SurfaceLanes, surface_lanes)
/// Those of best_instruction_level().
const SurfaceLanes& best_surface_lanes();

}  // namespace mallow

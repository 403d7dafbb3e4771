#pragma once

#include <cstddef>

#include "core/isa.h"

namespace mallow {

/// Voxels along a side of the blocks that are filled at once: the leaves of the level set.
inline constexpr int k_leaf_side = 8;
inline constexpr int k_leaf_voxels = k_leaf_side * k_leaf_side * k_leaf_side;

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
  float background;    ///< distances are cut here [voxels]
  bool probe;          ///< the voxels are so fine against the particles that nine rows tell what is in a leaf
};

enum class LeafContent { outside, inside, surface };

struct SurfaceKernels {
  /// Fills `distances`, z fastest, with the signed distances of a leaf's voxels [voxels], unless the leaf
  /// lies deep inside or outside. `x, y, z`: offsets of `count` particles from the leaf's first voxel
  /// [voxels]; `scratch`: 3 · count floats.
  LeafContent (*fill_leaf)(const SurfaceShape&, const float* x, const float* y, const float* z,
                           std::size_t count, float* scratch, float* distances) noexcept;
};
MALLOW_DECLARE_LEVELS(SurfaceKernels, surface_kernels)
const SurfaceKernels& select_surface_kernels(InstructionLevel level);

}  // namespace mallow

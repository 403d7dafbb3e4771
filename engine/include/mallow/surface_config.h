#pragma once

#include <optional>

namespace mallow {

/// How a surface is drawn around particles.
struct SurfaceConfig {
  /// Voxels along the longest side of the particles' bounding box, in [8, 1024]; used where voxel_size is
  /// left out.
  int voxels = 128;
  /// Side of a voxel [m], > 0.
  std::optional<float> voxel_size = {};
  /// Radius of the kernels that blend the particles, in spacings, in [1, 4].
  float kernel_radius = 2.0f;
  /// Distance of the surface from the outermost particles, in spacings, in [0.1, 1].
  float particle_radius = 0.55f;
};

}  // namespace mallow

#pragma once

#include <optional>

namespace mallow {

/// What the surface is the zero of.
enum class SurfaceKind {
  blended,  ///< the distance from the kernel-weighted mean of the particles near by: smooth [Zhu & Bridson
            ///< 2005]
  anisotropic,  ///< where the density of kernels that follow the shape of each particle's neighbourhood is
                ///< that of a face: smoother still, at twice the cost [Yu & Turk 2013]
  spheres,      ///< the distance from the nearest particle: a sphere around each, fast and rough
};

/// How a surface is drawn around particles.
struct SurfaceConfig {
  /// Voxels a spacing, in [0.5, 16], of the particles that a surface is drawn around: where bodies have
  /// surfaces of their own each has voxels for its own spacing, and joined ones have them for the widest.
  /// Counts where voxel_size and voxels are left out. A splash of 1,000 particles, in the mean off what fine
  /// voxels show: 2 takes 0.5 ms on one thread, 0.028 h; 2.7 takes 0.8 ms, 0.017 h; 3 takes 1.0 ms, 0.014 h;
  /// 4 takes 1.9 ms, 0.008 h. Finer ones show ripples; below 1.6 lone particles are lost.
  float voxels_per_spacing = 2.7f;
  /// Side of a voxel [m], > 0, whatever the spacing is.
  std::optional<float> voxel_size = {};
  /// Voxels along the longest side of the particles' bounding box, in [8, 1024]; counts where voxel_size is
  /// left out. The paper counts so [TK Table 1]. Voxels grow and shrink with the box then, in every frame
  /// anew: where something flies off, the surface of all else gets coarser and flickers.
  std::optional<int> voxels = {};
  /// Radius of the kernels that blend the particles, in spacings, in [1, 4]; from 2 on where they are
  /// anisotropic. 2 keeps edges of boxes within 0.40 spacings, and what is cut or lies side by side apart. 2.5
  /// hides the particles of sheets and strands, but edges are 0.53 off, and parts 2.3 spacings apart melt.
  float kernel_radius = 2.0f;
  /// Distance of the surface from the outermost particles, in spacings, in [0.1, 1].
  float particle_radius = 0.55f;
  SurfaceKind kind = SurfaceKind::blended;
  /// One surface around all bodies, which melts where they touch, in place of one around each. The widest
  /// spacing counts for all.
  bool joined = false;
  /// Where the surface is even, vertices are merged, in cubes of up to eight voxels a side, as long as that
  /// moves it by no more than this many voxels, in [0, 1]. 0: all triangles are about a voxel large.
  float adaptivity = 0;
  /// Rounds that smooth the mesh, in [0, 100]; each evens out bumps of about a voxel and keeps the volume
  /// [Taubin 1995]; pieces two voxels wide shrink, to a half in 10 rounds.
  int smoothing = 0;
  /// Memory that a surface may take [GiB], > 0; one that would need more is refused before it is allocated.
  float memory_limit = 4.0f;
};

}  // namespace mallow

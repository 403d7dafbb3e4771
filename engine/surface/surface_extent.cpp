#include "surface/surface_extent.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "mallow/errors.h"
#include "surface/block_map.h"
#include "surface/particle_order.h"

namespace mallow {
namespace {

/// Voxels along an axis: keeps the numbers of blocks within 21 bits and offsets within a block exact.
constexpr int k_max_side = 1 << 22;
/// Voxels from one origin to the next: a whole number of cubes of BlockMap. Where the side of a voxel is a
/// float places on the grid are exact, and origins can lie far apart: so they stay where they are while
/// particles come and go, and surfaces of bodies that rest are kept.
constexpr int k_lattice = BlockMap::k_cube_side * k_block_side, k_wide_lattice = 1 << 18;

/// Side of the voxels of a surface [m]. A float, where it does not follow the box: a whole number of such
/// sides is exact in double, and so are places on the grid wherever its origin is.
double voxel_size(const SurfaceConfig& config, float spacing, const Extent& extent) {
  if (config.voxel_size) return static_cast<double>(*config.voxel_size);
  if (config.voxels) return extent.longest_side / *config.voxels;
  return static_cast<double>(spacing / config.voxels_per_spacing);
}

}  // namespace

Extent extent_of(const SurfaceParticles& particles, double margin) {
  constexpr float k_far = std::numeric_limits<float>::max();
  Vec3 low = Vec3::Constant(k_far), high = -low;
  for (const SurfaceBody& body : particles.bodies) {
    const Simulation::Rows rows = rows_of(body, particles.positions.size());
    for (std::size_t row = rows.begin; row < rows.end; ++row) {
      const Vec3 x = particles.positions[row];
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  }
  const Eigen::Vector3d corner = low.cast<double>();
  return {corner, (high.cast<double>() - corner).maxCoeff() + 2 * margin};
}

VoxelFrame make_frame(const SurfaceConfig& config, float spacing, const Extent& extent) {
  VoxelFrame frame;
  frame.voxel_size = voxel_size(config, spacing, extent);
  const bool follows_box = config.voxels && !config.voxel_size;
  frame.whole = !follows_box;
  const double side = (follows_box ? k_lattice : k_wide_lattice) * frame.voxel_size;
  frame.origin = (extent.low / side).array().floor() * side;
  if (extent.longest_side / frame.voxel_size > k_max_side) {
    std::ostringstream text;
    text << "voxels of " << frame.voxel_size << " m are too small for these particles: the grid would be "
         << extent.longest_side / frame.voxel_size << " voxels long, and " << k_max_side << " are allowed";
    throw ConfigError("surface.voxel_size", text.str());
  }
  return frame;
}

}  // namespace mallow

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mallow/vec3.h"

namespace mallow {

/// Where the voxels of a grid lie: voxel (i, j, k) is the point origin + voxel_size · (i, j, k).
struct VoxelFrame {
  Eigen::Vector3d origin{
      0, 0, 0};           ///< [m], a whole multiple of voxel_size, so that frames of a film share one grid
  double voxel_size = 1;  ///< [m]
};

/// Offsets of particles from a point, one array per component.
struct Offsets {
  std::vector<float> x, y, z;
  void clear() {
    x.clear();
    y.clear();
    z.clear();
  }
};

/// Particles in voxels of a frame, sorted by cubic cells that exist only where particles are.
class ParticleCells {
 public:
  /// Positions are finite and nowhere below frame.origin; the frame is at most 2^20 cells of `cell_size`
  /// voxels long.
  ParticleCells(std::span<const Vec3> positions, const VoxelFrame& frame, double cell_size);

  std::span<const Eigen::Vector3d> positions() const { return positions_; }
  /// Offsets from voxel `corner` of all particles within `radius` voxels of the box of `side` voxels that
  /// starts there, in an order that depends on the particles only.
  void gather(const Eigen::Vector3i& corner, int side, double radius, Offsets& out) const;

 private:
  std::uint64_t key(const Eigen::Vector3i& cell) const;
  Eigen::Vector3i cell_at(const Eigen::Vector3d& x) const;

  double cell_size_;
  Eigen::Vector3i dims_{1, 1, 1};
  std::vector<Eigen::Vector3d> positions_;  ///< [voxels], sorted by cell
  std::vector<std::uint64_t> keys_;         ///< of each cell that holds a particle, ascending
  std::vector<std::uint32_t> begins_;  ///< first particle of each of these cells, and the end of the last
};

}  // namespace mallow

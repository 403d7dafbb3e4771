#pragma once

#include <cstddef>
#include <string>

#include "mallow/vec3.h"

namespace mallow {

/// Voxels along a side of the blocks that level sets are kept in, those of an OpenVDB leaf.
inline constexpr int k_block_side = 8;
inline constexpr std::size_t k_block_voxels = 512;
/// Blocks, and groups of 2 × 2 × 2 of them, that a thread takes at once.
inline constexpr std::size_t k_blocks_at_once = 8, k_groups_at_once = 2;

/// Where the voxels of a grid lie: voxel (i, j, k) is the point origin + voxel_size · (i, j, k).
struct VoxelFrame {
  Eigen::Vector3d origin{0, 0, 0};  ///< [m], on a lattice that is whole in blocks: frames of a film share it
  double voxel_size = 1;            ///< [m]
  /// The origin is a whole number of voxels, exactly: points follow from numbers of voxels alone, and have
  /// the same bits whatever origin these are counted from.
  bool whole = false;

  /// A point is base() + voxel_size · (shift() + voxel).
  Eigen::Vector3d base() const { return whole ? Eigen::Vector3d(0, 0, 0) : origin; }
  Eigen::Vector3d shift() const {
    return whole ? Eigen::Vector3d(origin / voxel_size) : Eigen::Vector3d(0, 0, 0);
  }
  Vec3 point(const Eigen::Vector3d& voxel) const {
    return (base() + voxel_size * (shift() + voxel)).cast<float>();
  }
};

}  // namespace mallow

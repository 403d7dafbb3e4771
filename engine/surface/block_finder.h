#pragma once

#include <cstdint>
#include <vector>

#include "core/threads.h"
#include "surface/block_map.h"
#include "surface/particle_cells.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// Finds the blocks that a surface may pass through. Keeps its memory.
class BlockFinder {
 public:
  /// Every block with a voxel within `reach` voxels of a particle, and some more. memory_limit: [GiB]; throws
  /// ConfigError where the surface would take more.
  void find(const ParticleCells& particles, const VoxelFrame& frame, double reach, float memory_limit,
            const Threads& threads, BlockMap& blocks);
  std::size_t bytes() const {
    return (runs_.capacity() + open_.capacity()) * sizeof(Run) + counts_.capacity() * sizeof(std::size_t);
  }

 private:
  /// Particles that follow each other and lie in one block.
  struct Run {
    std::uint64_t block = UINT64_MAX;               ///< orders runs by block; nobody's to begin with
    BlockMap::Coord first{0, 0, 0}, last{0, 0, 0};  ///< corners of the box of blocks within their reach
  };
  void find_runs(const ParticleCells& particles, const VoxelFrame& frame, double reach,
                 const Threads& threads);

  std::vector<Run> runs_;
  std::vector<std::size_t> counts_;  ///< of runs of each k_block particles, whose place they are at
  std::vector<Run> open_;            ///< runs that more of their block may come to, by its key
};

}  // namespace mallow

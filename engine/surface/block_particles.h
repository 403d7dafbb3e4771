#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/threads.h"
#include "surface/block_map.h"
#include "surface/ellipsoids.h"
#include "surface/particle_cells.h"
#include "surface/sum_lanes.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// The particles near one block, in the order of their numbers.
struct BlockNear {
  std::size_t count = 0;
  ConstVectors positions{};              ///< from the block's first voxel [kernel radii]
  const std::uint32_t* which = nullptr;  ///< of those near its group
  std::span<const std::uint32_t> group_places;
  // Where each has its own kernel.
  std::vector<Ellipsoid> shapes;
  std::vector<float> reach[3];

  // Memory for what these point to, and for lanes.
  std::vector<float> axes[3];
  std::vector<std::uint32_t> numbers, listed;

  std::uint32_t place(std::size_t k) const { return group_places[which[k]]; }
  NearColumns columns() { return {positions, count, listed.data()}; }
  ConstVectors reaches() const { return {reach[0].data(), reach[1].data(), reach[2].data()}; }
};

/// The particles that a surface is drawn around, as its blocks see them. Those near each group of 2 × 2 × 2
/// blocks are searched for once a frame. Keeps its memory.
class BlockParticles {
 public:
  /// positions: finite. spacing: their h [m]. radius: of the kernels [m].
  void sort(const PickedVectors& positions, float spacing, float radius, const Threads& threads);
  /// Gives each particle a kernel of its own, and moves it there.
  void shape(const AnisotropyModel& model, const Threads& threads);
  void find_near(const BlockMap& blocks, const VoxelFrame& frame, const Threads& threads);

  const ParticleCells& cells() const { return cells_; }
  /// The particles near a block.
  void find(const BlockMap& blocks, const VoxelFrame& frame, std::uint32_t block, BlockNear& near) const;
  /// Keeps what was found of a block for the next time that it is looked for, until the next find_near().
  void keep(std::uint32_t block, const BlockNear& near);
  std::size_t bytes() const;

 private:
  /// The particles near a group.
  struct NearGroup {
    std::vector<std::uint32_t> places;
    std::vector<float> axes[3];  ///< positions [m], with room for k_cluster more
  };
  /// What was found of a block.
  struct Kept {
    bool there = false;
    std::size_t count = 0;
    std::vector<float> axes[3];
    std::vector<std::uint32_t> which;
  };
  void pick(const VoxelFrame& frame, const BlockMap::Coord& block, const NearGroup& group,
            BlockNear& near) const;
  void drop_out_of_reach(float side, BlockNear& near) const;

  ParticleCells cells_;
  Ellipsoids ellipsoids_;
  bool shaped_ = false;
  std::vector<NearGroup> near_;  ///< of each group
  std::vector<Kept> kept_;       ///< of each block
};

}  // namespace mallow

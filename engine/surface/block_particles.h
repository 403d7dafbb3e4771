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

/// The particles near one block, in the order of their numbers, and memory for those near its group.
struct BlockNear {
  std::size_t count = 0;
  std::vector<float> axes[3];  ///< from the block's first voxel [kernel radii]
  // Where each has its own kernel.
  std::vector<Ellipsoid> shapes;
  std::vector<float> reach[3];

  // Those near its group.
  std::span<const std::uint32_t> group_places;
  ConstVectors group{};              ///< positions [m]
  std::vector<std::uint32_t> which;  ///< of those it has
  std::vector<std::uint32_t> listed;

  std::uint32_t place(std::size_t k) const { return group_places[which[k]]; }
  NearColumns columns() { return {of(axes), count, listed.data()}; }
  ConstVectors reaches() const { return of(reach); }

 private:
  static ConstVectors of(const std::vector<float>* v) { return {v[0].data(), v[1].data(), v[2].data()}; }
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
  /// What pick() reads of the group of a block.
  void load_group(std::uint32_t group, BlockNear& near) const;
  /// The particles near a block of the group loaded last.
  void pick(const BlockMap& blocks, const VoxelFrame& frame, std::uint32_t block, BlockNear& near) const;
  std::size_t bytes() const;

 private:
  /// The particles near a group.
  struct NearGroup {
    std::vector<std::uint32_t> places;
    std::vector<float> axes[3];  ///< positions [m], with room for k_cluster more
  };
  void drop_out_of_reach(float side, BlockNear& near) const;

  ParticleCells cells_;
  Ellipsoids ellipsoids_;
  bool shaped_ = false;
  std::vector<NearGroup> near_;  ///< of each group
};

}  // namespace mallow

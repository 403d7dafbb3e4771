#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/threads.h"
#include "mallow/surface_config.h"
#include "surface/block_finder.h"
#include "surface/block_map.h"
#include "surface/block_particles.h"
#include "surface/cell_lanes.h"
#include "surface/node_weights.h"
#include "surface/picked_vectors.h"
#include "surface/surface_lanes.h"
#include "surface/voxel_frame.h"

namespace mallow {

enum class BlockKind : std::uint8_t { outside, inside, surface };

/// Number among a block's 27 neighbours, itself included, of the one `offset` away (each of −1, 0, 1).
inline std::size_t neighbor_slot(int dx, int dy, int dz) {
  return static_cast<std::size_t>((dx + 1) * 9 + (dy + 1) * 3 + dz + 1);
}
/// The level set of the surface around particles: signed distances [voxels], negative inside, in the blocks
/// that the surface passes through; all other blocks are wholly inside or outside. Keeps its memory from one
/// frame to the next.
///
/// The sums that give a distance are smooth over a kernel radius. Where that is many voxels they are taken at
/// every second or fourth voxel and interpolated; sums about the voxels themselves would cost 8 or 64 times
/// as much and be a few hundredths of a voxel more exact.
class SurfaceField {
 public:
  /// Nothing is inside.
  void clear();
  /// positions: finite. spacing: their h [m]. Throws ConfigError where the blocks would take
  /// more than config.memory_limit.
  void build(const PickedVectors& positions, float spacing, const SurfaceConfig& config,
             const VoxelFrame& frame, const Threads& threads);

  const VoxelFrame& frame() const { return frame_; }
  const BlockMap& blocks() const { return blocks_; }
  /// The blocks around a block, by neighbor_slot(); k_no_block, which is outside, where there is none.
  const std::array<std::uint32_t, 27>& neighbors(std::uint32_t block) const { return neighbors_[block]; }
  BlockKind kind(std::uint32_t block) const { return kind_[block]; }
  /// The 512 distances of a surface block, z fastest.
  const float* distances(std::uint32_t block) const { return distances_.data() + place_[block]; }
  /// Where these are below 0.
  const BlockBits& signs(std::uint32_t block) const { return signs_[block]; }
  /// Kernel-weighted means of the particles' values at points near a block. points: a whole number of eights,
  /// [voxels] from the block's first voxel. values: by particle, as they were given to build().
  void mean_at(std::uint32_t block, ConstVectors points, std::size_t n, const PickedVectors& values,
               Vectors means) const;
  /// The body with the largest share of the kernel-weighted particles at points as those of mean_at(), the
  /// smallest of equals; 0 where no particle is near. bodies: by particle. found: as many as there are
  /// points, without those that fill up to eights.
  void body_at(std::uint32_t block, ConstVectors points, std::size_t n, std::span<const std::uint32_t> bodies,
               std::span<std::uint32_t> found) const;
  std::size_t bytes() const;

  /// Distances are cut here [voxels].
  static constexpr float k_background = 3.0f;

 private:
  template <class Needed, class Visit>
  void for_each_block(const Threads& threads, const Needed& needed, const Visit& visit) const;
  BlockNear& near_block(std::uint32_t block) const;
  template <class Value>
  void mean_at(BlockNear& near, ConstVectors points, std::size_t n, const Value& value, Vectors means) const;
  PointLattice lattice(int step) const { return {.step = step, .voxel = shape_.voxel_size}; }
  void find_distances(const PointLattice& points, BlockNear& near, float* sums, float* distances) const;
  void probe(const Threads& threads);
  void classify(const Threads& threads);
  void sum_at_nodes(const Threads& threads);
  void fill(const Threads& threads);
  void note_sides(std::uint32_t block, const float* distances, bool touched);
  BlockKind kind_by_probes(std::uint32_t block) const;
  void find_rows(std::uint32_t block, NodeRows& rows) const;
  void collect_rows(std::uint32_t block, NodeRows& rows, float* nodes) const;
  const float* sums_of(std::uint32_t block) const;

  VoxelFrame frame_;
  SurfaceShape shape_{};
  float radius_ = 0;  ///< of the kernel [m]
  SurfaceKind surface_kind_ = SurfaceKind::blended;
  int node_step_ = 1;   ///< voxels between the nodes that sums are taken at: 1, 2 or 4
  int probe_step_ = 1;  ///< voxels between the nodes that tell whether the surface is in a block
  float deep_ = 0;      ///< distances at or below this are inside of a body for certain [voxels]
  NodeWeights weights_{};

  BlockParticles particles_;
  BlockFinder finder_;
  BlockMap blocks_;
  std::vector<std::array<std::uint32_t, 27>> neighbors_;
  std::vector<BlockKind> kind_;
  std::vector<std::uint8_t> needs_nodes_;
  /// Of each block, a bit for each slot: whether all of its probes are outside, and inside. Slot 4 x + 2 y +
  /// z of 0 and 1: along an axis that has a 1 only those of the first slice count.
  std::vector<std::uint8_t> outside_, inside_;
  Column<float> node_sums_;  ///< of the blocks that need them
  std::vector<std::size_t> node_place_, place_;
  std::vector<BlockBits> signs_;  ///< of each block, set where the surface is in it
  Column<float> distances_;
};

}  // namespace mallow

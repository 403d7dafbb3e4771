#include "surface/block_particles.h"

#include <algorithm>

#include "core/parallel.h"
#include "mallow/instruction_level.h"

namespace mallow {
namespace {

Eigen::Vector3d corner_of(const VoxelFrame& frame, const BlockMap::Coord& block) {
  return frame.origin + frame.voxel_size * k_block_side * block.cast<double>();
}

/// Makes room for `size` values; keeps what there is.
template <class T>
void make_room(std::vector<T>& values, std::size_t size) {
  if (values.size() < size) values.resize(size);
}

}  // namespace

const SumLanes& best_sum_lanes() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, sum_lanes);
}

void BlockParticles::sort(const PickedVectors& positions, float spacing, float radius,
                          const Threads& threads) {
  shaped_ = false;
  cells_.sort(positions, spacing, radius, threads);
}

void BlockParticles::shape(const AnisotropyModel& model, const Threads& threads) {
  ellipsoids_.fit(model, cells_.radius(), threads, cells_);
  shaped_ = true;
}

void BlockParticles::find_near(const BlockMap& blocks, const VoxelFrame& frame, const Threads& threads) {
  const auto groups = blocks.groups();
  if (near_.size() < groups.size()) near_.resize(groups.size());
  if (kept_.size() < blocks.size()) kept_.resize(blocks.size());
  for (Kept& kept : kept_) kept.there = false;
  const double side = frame.voxel_size * (2 * k_block_side - 1);
  parallel_for(
      threads, groups.size(),
      [&](std::size_t begin, std::size_t end) {
        thread_local NearParticles near;
        for (std::size_t g = begin; g < end; ++g) {
          cells_.find_places_near(corner_of(frame, groups[g].first), side, near);
          near_[g].places.assign(near.places.data(), near.places.data() + near.count);
          cells_.positions(near_[g].places, near_[g].axes);
        }
      },
      k_groups_at_once);
}

void BlockParticles::keep(std::uint32_t block, const BlockNear& near) {
  if (shaped_) return;
  Kept& kept = kept_[block];
  kept.there = true;
  kept.count = near.count;
  // With what follows, which is far away.
  const std::size_t room = near.count + k_cluster;
  const float* const from[3] = {near.positions.x, near.positions.y, near.positions.z};
  for (std::size_t a = 0; a < 3; ++a) kept.axes[a].assign(from[a], from[a] + room);
  kept.which.assign(near.which, near.which + near.count);
}

void BlockParticles::find(const BlockMap& blocks, const VoxelFrame& frame, std::uint32_t block,
                          BlockNear& near) const {
  const NearGroup& group = near_[blocks.group_of(block)];
  near.group_places = group.places;
  if (const Kept& kept = kept_[block]; kept.there) {
    near.count = kept.count;
    near.positions = {kept.axes[0].data(), kept.axes[1].data(), kept.axes[2].data()};
    near.which = kept.which.data();
  } else {
    pick(frame, blocks.blocks()[block], group, near);
  }
  make_room(near.listed, NearColumns::k_lists * (near.count + k_cluster));
}

void BlockParticles::pick(const VoxelFrame& frame, const BlockMap::Coord& block, const NearGroup& group,
                          BlockNear& near) const {
  const std::size_t room = group.places.size() + k_cluster;
  for (std::vector<float>& axis : near.axes) make_room(axis, room);
  make_room(near.numbers, room);
  const Eigen::Vector3d corner = corner_of(frame, block);
  const auto radius = static_cast<double>(cells_.radius());
  const double side = frame.voxel_size * (k_block_side - 1);
  BlockBox box{};
  // As in the search for neighbours.
  box.squared_reach = cells_.radius() * cells_.radius() * (1 + k_reach_rounding);
  box.per_radius = 1 / radius;
  for (int a = 0; a < 3; ++a) {
    box.corner[a] = corner[a];
    box.low[a] = static_cast<float>(corner[a]);
    box.high[a] = static_cast<float>(corner[a] + side);
  }
  const Vectors to = {near.axes[0].data(), near.axes[1].data(), near.axes[2].data()};
  near.count =
      best_sum_lanes().pick_near(box, {group.axes[0].data(), group.axes[1].data(), group.axes[2].data()},
                                 group.places.size(), to, near.numbers.data());
  near.positions = {to.x, to.y, to.z};
  near.which = near.numbers.data();
  if (shaped_) drop_out_of_reach(static_cast<float>(side / radius), near);
}

/// Leaves the particles whose own kernels reach into the block, with these kernels.
void BlockParticles::drop_out_of_reach(float side, BlockNear& near) const {
  make_room(near.shapes, near.count);
  for (std::vector<float>& reach : near.reach) make_room(reach, near.count + k_cluster);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < near.count; ++k) {
    const Ellipsoid& shape = ellipsoids_.shapes()[near.place(k)];
    bool reaches = true;
    for (int a = 0; a < 3; ++a) {
      const float x = near.axes[a][k];
      reaches = reaches && x + shape.reach[a] >= 0 && x - shape.reach[a] <= side;
      near.axes[a][kept] = x;
      near.reach[a][kept] = (1 + k_reach_rounding) * shape.reach[a];
    }
    if (!reaches) continue;
    near.numbers[kept] = near.which[k];
    near.shapes[kept++] = shape;
  }
  near.count = kept;
  // What follows is far away and reaches nowhere.
  for (std::size_t a = 0; a < 3; ++a) {
    std::fill_n(near.axes[a].data() + kept, k_cluster, NearColumns::k_far);
    std::fill_n(near.reach[a].data() + kept, k_cluster, 0.0f);
  }
}

std::size_t BlockParticles::bytes() const {
  std::size_t bytes = cells_.bytes() + ellipsoids_.bytes() + near_.capacity() * sizeof near_[0];
  for (const NearGroup& near : near_)
    bytes += near.places.capacity() * sizeof(std::uint32_t) + 3 * near.axes[0].capacity() * sizeof(float);
  for (const Kept& kept : kept_)
    bytes += sizeof kept + kept.which.capacity() * sizeof(std::uint32_t) +
             3 * kept.axes[0].capacity() * sizeof(float);
  return bytes;
}

}  // namespace mallow

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

void BlockParticles::load_group(std::uint32_t group, BlockNear& near) const {
  const NearGroup& from = near_[group];
  near.group_places = from.places;
  near.group = {from.axes[0].data(), from.axes[1].data(), from.axes[2].data()};
  const std::size_t room = near.group_places.size() + k_cluster;
  for (std::vector<float>& axis : near.axes) make_room(axis, room);
  make_room(near.which, room);
  make_room(near.listed, NearColumns::k_lists * room);
}

void BlockParticles::pick(const BlockMap& blocks, const VoxelFrame& frame, std::uint32_t block,
                          BlockNear& near) const {
  const Eigen::Vector3d corner = corner_of(frame, blocks.blocks()[block]);
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
  near.count = best_sum_lanes().pick_near(box, near.group, near.group_places.size(),
                                          {near.axes[0].data(), near.axes[1].data(), near.axes[2].data()},
                                          near.which.data());
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
    near.which[kept] = near.which[k];
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
  return bytes;
}

}  // namespace mallow

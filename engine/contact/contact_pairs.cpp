#include "contact/contact_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/bounds.h"
#include "core/parallel.h"
#include "shape_matching/run_tables.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

/// Pairs of a point that there is room for from the start: more than rest or flow asks for, so that a motion
/// that goes on takes no more memory.
constexpr std::size_t k_room = 4;
/// The same of those near each of its points.
constexpr std::size_t k_room_near = 8;
/// The same of a block, whichever of its points have come near.
std::size_t room(const NearBlocks& near, std::size_t number) {
  const RangeBlocks::Block& block = near.blocks.blocks[number];
  return k_room * (block.end - block.begin);
}

/// From the middle of the regions of a particle to it, in the reference shape.
Vec3 rest_outward(const ShapeMatching& shape, std::size_t i) {
  const Vec3 x = shape.reference.get(i);
  if (shape.region_stride == 1) return x - shape.center.get(i);
  Vec3 middle = Vec3::Zero();
  const std::vector<std::uint32_t> regions = decode(shape.by_particle(), i);
  for (const std::uint32_t region : regions) middle += shape.center.get(region);
  return x - middle / static_cast<float>(regions.size());
}

/// N_i: which way out of its body a particle lies, and how near the surface. 0 in a fluid, which has no
/// shape.
Vec3 outward(const TouchingBody& body, std::size_t row) {
  if (!body.shape) return Vec3::Zero();
  const std::size_t i = row - body.begin, region = body.shape->first_region(i);
  const auto& q = body.shape->rotation;
  return Eigen::Quaternionf(q[3][region], q[0][region], q[1][region], q[2][region]) *
         rest_outward(*body.shape, i);
}

/// What is known of the points.
void gather(const VectorColumn& positions, const VectorColumn& velocities, const std::uint16_t* pin,
            const std::vector<TouchingBody>& bodies, const Threads& threads, ContactPairs& pairs) {
  const NearBlocks& near = pairs.near;
  const std::size_t n = near.row.size();
  pairs.positions.resize_unset(n);
  pairs.points.resize(n);
  pairs.velocity.resize(n);
  const std::size_t blocks = near.blocks.blocks.size();
  pairs.first_few.resize_unset(blocks + 1);
  pairs.first_few[0] = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t points = near.first_point[b + 1] - near.first_point[b];
    pairs.first_few[b + 1] =
        pairs.first_few[b] + static_cast<std::uint32_t>((points + k_cluster - 1) / k_cluster);
  }
  pairs.few_low.resize_unset(pairs.first_few[blocks]);
  pairs.few_high.resize_unset(pairs.first_few[blocks]);
  parallel_for(threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const TouchingBody& body = bodies[block.range];
    const float friction = std::sqrt(body.friction), adhesion = std::sqrt(body.adhesion);
    for (std::uint32_t p = near.first_point[number]; p < near.first_point[number + 1]; ++p) {
      const std::uint32_t row = near.row[p];
      const Vec3 x = positions.get(row), v = velocities.get(row), out = outward(body, row);
      const float depth = out.norm();
      pairs.positions.set(p, x);
      pairs.velocity[p] = {v, 0};
      pairs.points[p] = {.position = x,
                         .half_spacing = 0.5f * body.spacing,
                         .outward = depth > 0 ? Vec3(out / depth) : Vec3(0, 0, 0),
                         .depth = depth,
                         .inverse_mass = pin && pin[row] != 0 ? 0.0f : 1.0f / body.mass,
                         .friction = friction,
                         .adhesion = adhesion,
                         .unused = 0};
    }
    const std::size_t begin = near.first_point[number], end = near.first_point[number + 1];
    for (std::size_t few = pairs.first_few[number], from = begin; from < end; ++few, from += k_cluster) {
      const Aabb box = box_around(pairs.positions, from, std::min(from + k_cluster, end));
      pairs.few_low.set(few, box.min);
      pairs.few_high.set(few, box.max);
    }
  });
}

/// How points move, which is all that changes from call to call of one step.
void gather_velocities(const VectorColumn& velocities, const Threads& threads, ContactPairs& pairs) {
  parallel_for(threads, pairs.near.row.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) pairs.velocity[p] = {velocities.get(pairs.near.row[p]), 0};
  });
}

/// Points that are tried with others, with room for what lanes write behind them.
struct Candidates {
  std::vector<std::uint32_t> name;
  std::vector<float> x, y, z, along, across;
  std::size_t count = 0;

  void reserve(std::size_t points) {
    const std::size_t room = points + k_cluster;
    if (name.size() >= room) return;
    name.resize(room);
    for (std::vector<float>* column : {&x, &y, &z, &along, &across}) column->resize(room);
  }
  MeetingPoints columns() {
    return {name.data(), {x.data(), y.data(), z.data()}, along.data(), across.data()};
  }
};

/// What finding the pairs of a block needs on the way.
struct PairSearch {
  Candidates own, others;
  std::vector<std::uint32_t> first, second;  ///< points that may touch
};

ConstVectors from(const VectorColumn& column, std::size_t first) {
  return {column.x() + first, column.y() + first, column.z() + first};
}

/// Points of later blocks of other bodies near the box of some of a block.
void find_candidates(const ContactPairs& pairs, std::size_t number, const Aabb& box,
                     const ContactLanes& lanes, Candidates& found) {
  const NearBlocks& near = pairs.near;
  found.count = 0;
  for (const auto& [other, reach] : near.others[number]) {
    if (other < number || !are_near(box, near.block_motion[other].box, reach)) continue;
    const std::uint32_t first = near.first_point[other], last = near.first_point[other + 1];
    found.reserve(found.count + (last - first));
    const LaneBox wide = lane_box(box, reach);
    const std::size_t few = pairs.first_few[other];
    found.count += lanes.in_box(raw(pairs.positions), first, last, wide, from(pairs.few_low, few),
                                from(pairs.few_high, few), found.name.data() + found.count);
  }
}

/// Those of all points of a block, a few of them at a time.
void find_all_candidates(std::size_t number, const ContactLanes& lanes, ContactPairs& pairs) {
  const NearBlocks& near = pairs.near;
  const std::uint32_t begin = near.first_point[number], end = near.first_point[number + 1];
  BlockCandidates& block = pairs.candidates[number];
  block.points.clear();
  block.ends.clear();
  if (begin == end) return;
  thread_local Candidates others;
  others.reserve(4 * k_block);
  const std::size_t rows = near.blocks.blocks[number].end - near.blocks.blocks[number].begin;
  block.points.reserve(k_room_near * rows);
  block.ends.reserve((rows + k_cluster - 1) / k_cluster);
  for (std::size_t few = pairs.first_few[number]; few < pairs.first_few[number + 1]; ++few) {
    find_candidates(pairs, number, {pairs.few_low.get(few), pairs.few_high.get(few)}, lanes, others);
    block.points.insert(block.points.end(), others.name.begin(),
                        others.name.begin() + static_cast<std::ptrdiff_t>(others.count));
    block.ends.push_back(static_cast<std::uint32_t>(block.points.size()));
  }
}

/// The pairs of the points of a block with those of later ones. A few points at a time, which lie side by
/// side, are tried with what is near all of them.
void find_pairs(std::size_t number, const PairStep& step, const ContactLanes& lanes, ContactPairs& pairs) {
  const NearBlocks& near = pairs.near;
  const std::uint32_t begin = near.first_point[number], end = near.first_point[number + 1];
  BlockPairs& block = pairs.blocks[number];
  block.count = 0;
  pairs.sides[number].points.clear();
  if (begin == end) return;
  block.reserve(room(near, number));
  thread_local PairSearch search;
  auto& [own, others, first, second] = search;
  own.reserve(k_cluster);
  others.reserve(4 * k_block);
  const float* const velocity = near.block_motion[number].velocity.data();
  const BlockCandidates& candidates = pairs.candidates[number];
  std::uint32_t next = 0;
  for (std::uint32_t from = begin; from < end; from += k_cluster) {
    own.count = std::min<std::size_t>(k_cluster, end - from);
    const std::uint32_t first_other = next;
    next = candidates.ends[(from - begin) / k_cluster];
    others.count = next - first_other;
    if (others.count == 0) continue;
    others.reserve(others.count);
    std::copy_n(candidates.points.begin() + first_other, others.count, others.name.begin());
    std::iota(own.name.begin(), own.name.begin() + k_cluster, from);
    lanes.gather(pairs.rows(), step, velocity, own.count, own.columns());
    lanes.gather(pairs.rows(), step, velocity, others.count, others.columns());
    const std::size_t most = k_cluster * others.name.size();
    if (second.size() < most) {
      first.resize(most);
      second.resize(most);
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < own.count; ++i) {
      const std::size_t found =
          lanes.meeting(own.columns(), i, others.columns(), others.count, second.data() + count);
      std::fill_n(first.begin() + static_cast<std::ptrdiff_t>(count), found, own.name[i]);
      count += found;
    }
    block.reserve(block.count + count);
    block.count =
        lanes.add_pairs(pairs.rows(), step, first.data(), second.data(), count, block.columns(), block.count);
  }
}

/// In which pairs the points of a block are.
void find_sides(std::uint32_t number, ContactPairs& pairs) {
  struct Found {
    std::uint32_t point;
    BlockSides::Side side;
  };
  thread_local std::vector<Found> found;
  found.clear();
  found.reserve(4 * k_room * k_block);
  const NearBlocks& near = pairs.near;
  const std::uint32_t begin = near.first_point[number], end = near.first_point[number + 1];
  const auto find = [&](const BlockPairs& of, const std::vector<std::uint32_t>& points, float sign) {
    for (std::size_t k = 0; k < of.count; ++k)
      if (points[k] - begin < end - begin)  // below begin it wraps around
        found.push_back({points[k] - begin, {static_cast<std::uint32_t>(of.first + k), sign}});
  };
  find(pairs.blocks[number], pairs.blocks[number].own, 1);
  for (const NearBlocks::Other& other : near.others[number])
    if (other.block < number) find(pairs.blocks[other.block], pairs.blocks[other.block].other, -1);

  std::array<std::uint32_t, k_block> next{};
  for (const Found& one : found) ++next[one.point];
  BlockSides& block = pairs.sides[number];
  block.points.reserve(near.blocks.blocks[number].end - near.blocks.blocks[number].begin);
  std::uint32_t count = 0;
  for (std::uint32_t p = begin; p < end; ++p) {
    const std::uint32_t own = std::exchange(next[p - begin], count);
    count += own;
    if (own > 0) block.points.push_back({p, count});
  }
  if (block.sides.size() < count) block.sides.resize(std::max<std::size_t>(count, 2 * room(near, number)));
  for (const Found& one : found) block.sides[next[one.point]++] = one.side;
}

}  // namespace

PairColumns BlockPairs::columns() {
  return {own.data(),    other.data(),  {normal_x.data(), normal_y.data(), normal_z.data()},
          target.data(), sticks.data(), friction.data()};
}

void BlockPairs::reserve(std::size_t pairs) {
  const std::size_t room = pairs + k_cluster;
  if (own.size() >= room) return;
  own.resize(room);
  other.resize(room);
  for (std::vector<float>* column : {&normal_x, &normal_y, &normal_z, &target, &sticks, &friction})
    column->resize(room);
}

std::size_t BlockPairs::bytes() const {
  return own.capacity() * (2 * sizeof(std::uint32_t) + 6 * sizeof(float));
}

ContactRows ContactPairs::rows() const {
  static_assert(sizeof(ContactPoint) == 12 * sizeof(float) && sizeof(ContactVelocity) == 4 * sizeof(float));
  return {points.empty() ? nullptr : points.front().position.data(),
          velocity.empty() ? nullptr : velocity.front().velocity.data()};
}

std::size_t ContactPairs::bytes() const {
  std::size_t sum = near.bytes() + positions.bytes() + few_low.bytes() + few_high.bytes() +
                    first_few.bytes() + acts.bytes() + impulses.bytes() + sums.bytes() +
                    points.capacity() * sizeof(ContactPoint) + velocity.capacity() * sizeof(ContactVelocity);
  for (const BlockPairs& block : blocks) sum += block.bytes();
  for (const BlockCandidates& block : candidates)
    sum += (block.points.capacity() + block.ends.capacity()) * sizeof(std::uint32_t);
  for (const BlockSides& block : sides)
    sum += block.points.capacity() * sizeof(BlockSides::Touching) +
           block.sides.capacity() * sizeof(BlockSides::Side);
  return sum;
}

bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs) {
  const bool anew = find_near_blocks(positions, velocities, bodies, step, execution, pairs.near);
  if (pairs.near.row.empty()) return false;
  if (anew)
    gather(positions, velocities, pin, bodies, execution.threads, pairs);
  else
    gather_velocities(velocities, execution.threads, pairs);
  pairs.blocks.resize(pairs.near.blocks.blocks.size());
  pairs.candidates.resize(pairs.blocks.size());
  pairs.sides.resize(pairs.blocks.size());
  const ContactLanes& lanes = MALLOW_SELECT(execution.level, contact_lanes);
  const PairStep pair_step{step.time_step, step.max_push, pushed_together(step)};
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    if (anew) find_all_candidates(number, lanes, pairs);
    find_pairs(number, pair_step, lanes, pairs);
  });
  std::size_t count = 0;
  for (BlockPairs& block : pairs.blocks) {
    block.first = count;
    count += (block.count + k_cluster - 1) / k_cluster * k_cluster;  // lanes write whole clusters
  }
  if (count == 0) return false;
  pairs.acts.resize_unset(count);
  pairs.impulses.resize_unset(4 * count);
  pairs.sums.resize_unset(pairs.keeps_sums ? 4 * count : 0);
  std::fill_n(pairs.sums.data(), pairs.sums.size(), 0.0f);
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    find_sides(static_cast<std::uint32_t>(number), pairs);
  });
  return true;
}

}  // namespace mallow

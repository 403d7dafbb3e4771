#include "contact/near_blocks.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_lanes.h"
#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

void join(Moving& all, const Moving& part) {
  all.box = box_around(all.box, part.box);
  all.spread = std::max(all.spread, (part.velocity - all.velocity).norm() + part.spread);
}

void find_block_motions(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::vector<TouchingBody>& bodies, const Execution& execution,
                        NearBlocks& near) {
  near.blocks.clear();
  for (const TouchingBody& body : bodies) near.blocks.add(body.end - body.begin);
  const std::vector<RangeBlocks::Block>& blocks = near.blocks.blocks;
  near.block_motion.resize(blocks.size());
  const PointLanes& lanes = MALLOW_SELECT(execution.level, point_lanes);
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const std::size_t first = bodies[block.range].begin;
    LaneMotion found;
    lanes.motion(raw(positions), raw(velocities), first + block.begin, first + block.end, found);
    near.block_motion[number] = {{Eigen::Map<const Vec3>(found.low), Eigen::Map<const Vec3>(found.high)},
                                 Eigen::Map<const Vec3>(found.velocity),
                                 found.spread};
  });
}

void find_body_motions(NearBlocks& near) {
  near.body_motion.resize(near.blocks.ranges());
  for (std::size_t b = 0; b < near.body_motion.size(); ++b) {
    const std::uint32_t first = near.blocks.first[b], last = near.blocks.first[b + 1];
    Moving& body = near.body_motion[b] = {.box = empty_box(), .velocity = {0, 0, 0}};
    for (std::uint32_t k = first; k < last; ++k)
      body.velocity += near.block_motion[k].velocity / static_cast<float>(last - first);
    for (std::uint32_t k = first; k < last; ++k) join(body, near.block_motion[k]);
  }
}

/// Whether no block moves otherwise than it was thought to when near ones were found.
bool are_as_found(const NearBlocks& near) {
  for (std::size_t k = 0; k < near.block_motion.size(); ++k) {
    const Moving &now = near.block_motion[k], &found = near.found_motion[k];
    if (!((now.velocity - found.velocity).norm() + now.spread <= found.spread)) return false;
  }
  return true;
}

/// How far apart two points may be that touch in a step, however far they then come. spacing: the mean of
/// theirs. closing: how fast they come nearer [m/s], at most.
float unbounded_reach(float spacing, float closing, const BodyContactStep& step) {
  const float across = k_across * spacing, along = spacing + step.time_step * closing + pushed_together(step);
  return 1.001f * std::sqrt(across * across + along * along);
}

/// The same in this step.
float touching_reach(float spacing, float closing, const BodyContactStep& step) {
  return std::min(step.reach, unbounded_reach(spacing, closing, step));
}

/// How far two of these may be apart and touch in this step.
float reach_between(const Moving& a, const Moving& b, float spacing, const BodyContactStep& step) {
  return touching_reach(spacing, (a.velocity - b.velocity).norm() + (a.spread + b.spread), step);
}

/// The box of some of a body, so much wider that those of two that may touch in this step overlap: each has
/// half of the way, in a frame that moves with the mean of all.
Aabb widened(const Moving& own, float spacing, const BodyContactStep& step, const NearBlocks& near) {
  const float closing = 2 * ((own.velocity - near.mean_velocity).norm() + own.spread);
  // The reach of two is at most the mean of what each has by itself, and at most step.reach.
  const float half = 0.5f * unbounded_reach(spacing, closing, step);
  const float wider = std::min(step.reach, half) + 0.25f * spacing;
  return {own.box.min.array() - wider, own.box.max.array() + wider};
}

/// Where bodies are.
void place_bodies(const std::vector<TouchingBody>& bodies, const BodyContactStep& step, NearBlocks& near) {
  near.mean_velocity.setZero();
  for (const Moving& body : near.body_motion)
    near.mean_velocity += body.velocity / static_cast<float>(bodies.size());
  near.boxes.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    near.boxes[b] = widened(near.body_motion[b], bodies[b].spacing, step, near);
  near.tree.build(near.boxes);
}

/// Blocks of other bodies that a block may come near.
void find_other_blocks(const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                       std::uint32_t number, NearBlocks& near) {
  const std::uint32_t body = near.blocks.blocks[number].range;
  const Moving& own = near.block_motion[number];
  thread_local std::vector<std::uint32_t> other_bodies;
  other_bodies.clear();
  near.tree.for_overlapping(widened(own, bodies[body].spacing, step, near), [&](std::uint32_t other) {
    if (bodies[other].group != bodies[body].group && !(bodies[other].sleeps && bodies[body].sleeps))
      other_bodies.push_back(other);
  });
  std::ranges::sort(other_bodies);
  std::vector<NearBlocks::Other>& others = near.others[number];
  others.clear();
  for (const std::uint32_t other : other_bodies) {
    const float spacing = 0.5f * (bodies[body].spacing + bodies[other].spacing);
    const float reach = reach_between(own, near.body_motion[other], spacing, step);
    if (!are_near(own.box, near.body_motion[other].box, reach)) continue;
    for (std::uint32_t b = near.blocks.first[other]; b < near.blocks.first[other + 1]; ++b) {
      const float between = reach_between(own, near.block_motion[b], spacing, step);
      if (are_near(own.box, near.block_motion[b].box, between)) others.push_back({b, between});
    }
  }
}

}  // namespace

std::size_t NearBlocks::bytes() const {
  std::size_t sum =
      tree.bytes() + boxes.capacity() * sizeof(Aabb) +
      (block_motion.capacity() + body_motion.capacity() + found_motion.capacity()) * sizeof(Moving) +
      others.capacity() * sizeof(others.front()) + blocks.blocks.capacity() * sizeof(RangeBlocks::Block) +
      blocks.first.capacity() * sizeof(std::uint32_t);
  for (const std::vector<Other>& block : others) sum += block.capacity() * sizeof(Other);
  return sum;
}

LaneBox lane_box(const Aabb& box, float reach) {
  const Vec3 low = box.min.array() - reach, high = box.max.array() + reach;
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

bool find_near_blocks(const VectorColumn& positions, const VectorColumn& velocities,
                      const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                      const Execution& execution, NearBlocks& near) {
  find_block_motions(positions, velocities, bodies, execution, near);
  if (step.again && are_as_found(near)) return false;
  for (Moving& block : near.block_motion) block.spread += step.slack;
  near.found_motion = near.block_motion;
  find_body_motions(near);
  place_bodies(bodies, step, near);
  const std::size_t blocks = near.blocks.blocks.size();
  near.others.resize(blocks);
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    find_other_blocks(bodies, step, static_cast<std::uint32_t>(number), near);
  });
  return true;
}

}  // namespace mallow

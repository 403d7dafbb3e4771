#include "contact/near_blocks.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_lanes.h"
#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

/// The motion of some particles that is seen from their mean. What is no number is left for later phases to
/// find: it counts as no motion here.
Moving motion_of(const VectorColumn& positions, const VectorColumn& velocities, std::size_t begin,
                 std::size_t end) {
  Moving moving{.box = box_around(positions, begin, end), .velocity = {0, 0, 0}};
  for (std::size_t i = begin; i < end; ++i) moving.velocity += velocities.get(i);
  moving.velocity /= static_cast<float>(end - begin);
  if (!moving.velocity.allFinite()) moving.velocity.setZero();
  float square = 0;
  for (std::size_t i = begin; i < end; ++i)
    square = std::max(square, (velocities.get(i) - moving.velocity).squaredNorm());
  moving.spread = std::sqrt(square);
  return moving;
}

void join(Moving& all, const Moving& part) {
  all.box = box_around(all.box, part.box);
  all.spread = std::max(all.spread, (part.velocity - all.velocity).norm() + part.spread);
}

void find_block_motions(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::vector<TouchingBody>& bodies, const Threads& threads, NearBlocks& near) {
  near.blocks.clear();
  for (const TouchingBody& body : bodies) near.blocks.add(body.end - body.begin);
  const std::vector<RangeBlocks::Block>& blocks = near.blocks.blocks;
  near.block_motion.resize(blocks.size());
  parallel_for(threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const std::size_t first = bodies[block.range].begin;
    near.block_motion[number] = motion_of(positions, velocities, first + block.begin, first + block.end);
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

/// How far apart two points may be that touch in this step. spacing: the mean of theirs. closing: how fast
/// they come nearer [m/s], at most.
float touching_reach(float spacing, float closing, const BodyContactStep& step) {
  const float across = k_across * spacing, along = spacing + step.time_step * closing + pushed_together(step);
  return std::min(step.reach, 1.001f * std::sqrt(across * across + along * along));
}

/// How far two of these may be apart and touch in this step.
float reach_between(const Moving& a, const Moving& b, float spacing, const BodyContactStep& step) {
  return touching_reach(spacing, (a.velocity - b.velocity).norm() + (a.spread + b.spread), step);
}

/// Sweeps over the bodies along the axis on which they are spread most, each as wide as it may reach in a
/// frame that moves with the mean of all.
void find_other_bodies(const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                       NearBlocks& near) {
  const std::size_t n = bodies.size();
  near.other_bodies.resize(n);
  near.by_place.resize(n);
  near.lowest.resize(n);
  near.highest.resize(n);
  Aabb all = empty_box();
  Vec3 velocity = Vec3::Zero();
  for (std::uint32_t b = 0; b < n; ++b) {
    near.other_bodies[b].clear();
    near.by_place[b] = b;
    const Vec3 low = near.body_motion[b].box.min;
    all = box_around(all, {low, low});
    velocity += near.body_motion[b].velocity / static_cast<float>(n);
  }
  int axis = 0;
  (all.max - all.min).maxCoeff(&axis);
  for (std::size_t b = 0; b < n; ++b) {
    const Moving& body = near.body_motion[b];
    const float closing = 2 * ((body.velocity - velocity).norm() + body.spread);
    const float own = 0.5f * touching_reach(bodies[b].spacing, closing, step) + 0.25f * bodies[b].spacing;
    near.lowest[b] = body.box.min[axis] - own;
    near.highest[b] = body.box.max[axis] + own;
  }
  std::ranges::sort(near.by_place, [&](std::uint32_t a, std::uint32_t b) {
    return near.lowest[a] != near.lowest[b] ? near.lowest[a] < near.lowest[b] : a < b;
  });
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t a = near.by_place[k];
    for (std::size_t l = k + 1; l < n && near.lowest[near.by_place[l]] <= near.highest[a]; ++l) {
      const std::uint32_t b = near.by_place[l];
      if (bodies[a].group == bodies[b].group || (bodies[a].sleeps && bodies[b].sleeps)) continue;
      const float reach = reach_between(near.body_motion[a], near.body_motion[b],
                                        0.5f * (bodies[a].spacing + bodies[b].spacing), step);
      if (!are_near(near.body_motion[a].box, near.body_motion[b].box, reach)) continue;
      near.other_bodies[a].push_back(b);
      near.other_bodies[b].push_back(a);
    }
  }
  for (std::vector<std::uint32_t>& others : near.other_bodies) std::ranges::sort(others);
}

/// Blocks of other bodies that a block may come near.
void find_other_blocks(const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                       std::uint32_t number, NearBlocks& near) {
  const std::uint32_t body = near.blocks.blocks[number].range;
  const Moving& own = near.block_motion[number];
  std::vector<NearBlocks::Other>& others = near.others[number];
  others.clear();
  for (const std::uint32_t other : near.other_bodies[body]) {
    const float spacing = 0.5f * (bodies[body].spacing + bodies[other].spacing);
    const float reach = reach_between(own, near.body_motion[other], spacing, step);
    if (!are_near(own.box, near.body_motion[other].box, reach)) continue;
    for (std::uint32_t b = near.blocks.first[other]; b < near.blocks.first[other + 1]; ++b) {
      const float between = reach_between(own, near.block_motion[b], spacing, step);
      if (are_near(own.box, near.block_motion[b].box, between)) others.push_back({b, between});
    }
  }
}

/// Rows of a block that are near one of the others. Returns how many.
std::uint32_t find_points(const VectorColumn& positions, const NearBlocks& near, std::uint32_t number,
                          std::size_t begin, std::size_t end, const ContactLanes& lanes,
                          std::uint32_t* found) {
  thread_local std::vector<LaneBox> boxes;
  boxes.clear();
  for (const auto& [other, reach] : near.others[number])
    boxes.push_back(lane_box(near.block_motion[other].box, reach));
  std::uint32_t rows[k_block + k_cluster];
  const std::size_t count = lanes.in_boxes(raw(positions), begin, end, boxes.data(), boxes.size(), rows);
  std::copy_n(rows, count, found);
  return static_cast<std::uint32_t>(count);
}

}  // namespace

LaneBox lane_box(const Aabb& box, float reach) {
  const Vec3 low = box.min.array() - reach, high = box.max.array() + reach;
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

bool find_near_blocks(const VectorColumn& positions, const VectorColumn& velocities,
                      const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                      const Execution& execution, NearBlocks& near) {
  find_block_motions(positions, velocities, bodies, execution.threads, near);
  if (step.again && are_as_found(near)) return false;
  for (Moving& block : near.block_motion) block.spread += step.slack;
  near.found_motion = near.block_motion;
  find_body_motions(near);
  find_other_bodies(bodies, step, near);
  const std::size_t blocks = near.blocks.blocks.size();
  near.others.resize(blocks);
  near.first_point.resize_unset(blocks + 1);
  near.found.resize_unset(positions.size());
  const ContactLanes& lanes = MALLOW_SELECT(execution.level, contact_lanes);
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t b) {
    const auto number = static_cast<std::uint32_t>(b);
    const std::size_t first = bodies[block.range].begin;
    find_other_blocks(bodies, step, number, near);
    near.first_point[b + 1] = find_points(positions, near, number, first + block.begin, first + block.end,
                                          lanes, near.found.data() + first + block.begin);
  });
  near.first_point[0] = 0;
  for (std::size_t b = 0; b < blocks; ++b) near.first_point[b + 1] += near.first_point[b];
  near.row.resize_unset(near.first_point[blocks]);
  for (std::size_t b = 0; b < blocks; ++b) {
    const RangeBlocks::Block& block = near.blocks.blocks[b];
    std::copy_n(near.found.data() + bodies[block.range].begin + block.begin,
                near.first_point[b + 1] - near.first_point[b], near.row.data() + near.first_point[b]);
  }
  return true;
}

}  // namespace mallow

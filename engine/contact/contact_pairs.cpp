#include "contact/contact_pairs.h"

#include <algorithm>
#include <utility>

#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

/// Pairs of a point that there is room for from the start: more than rest or flow asks for, so that a motion
/// that goes on takes no more memory.
constexpr std::size_t k_room = 4;
/// The same of fews near each of a block.
constexpr std::size_t k_room_near = 24;
/// The same of pairs of a block, whichever of its points have come near.
std::size_t room(const NearBlocks& near, std::size_t number) {
  const RangeBlocks::Block& block = near.blocks.blocks[number];
  return k_room * (block.end - block.begin);
}

/// Whether no few moves otherwise than it was thought to when near ones were found.
bool are_as_found(const ContactPoints& points) {
  const FewMotion &now = points.motion, &found = points.found_motion;
  for (std::size_t k = 0; k < now.spread.size(); ++k)
    if (!((now.velocity.get(k) - found.velocity.get(k)).norm() + now.spread[k] <= found.spread[k]))
      return false;
  return true;
}

/// A block that another may touch.
struct OtherBlock {
  std::uint32_t body;
  FewReach reach;
  std::size_t first, last;  ///< fews
  std::uint32_t near;       ///< a bit for each few of the one that is near
};

/// Later ones of other bodies.
void list_others(std::size_t number, const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                 const FewColumns& fews, const PointLanes& lanes, const ContactPairs& pairs,
                 std::vector<OtherBlock>& others) {
  const NearBlocks& near = pairs.near;
  const ContactPoints& points = pairs.points;
  const float own_spacing = bodies[near.blocks.blocks[number].range].spacing;
  others.clear();
  for (const auto& [other, reach] : near.others[number]) {
    if (other < number) continue;
    const std::uint32_t body = near.blocks.blocks[other].range;
    const Aabb& box = near.block_motion[other].box;
    const Vec3 low = box.min.array() - reach, high = box.max.array() + reach;
    const std::uint32_t found = lanes.fews_in_box(fews, points.first_few(number),
                                                  points.first_few(number + 1), low.data(), high.data());
    if (found == 0) continue;
    const float spacing = 0.5f * (own_spacing + bodies[body].spacing);
    others.push_back({.body = body,
                      .reach = {.time_step = step.time_step,
                                .across = k_across * spacing,
                                .along = spacing + pushed_together(step),
                                .most = step.reach},
                      .first = points.first_few(other),
                      .last = points.first_few(other + 1),
                      .near = found});
  }
}

/// Fews of later blocks of other bodies near each of a block.
void find_near_fews(std::size_t number, const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                    const PointLanes& lanes, ContactPairs& pairs) {
  ContactPoints& points = pairs.points;
  BlockCandidates& block = pairs.candidates[number];
  block.clear();
  const auto begin = static_cast<std::uint32_t>(points.first_few(number)),
             end = static_cast<std::uint32_t>(points.first_few(number + 1));
  if (begin == end) return;
  const FewColumns columns{raw(points.low), raw(points.high), raw(points.found_motion.velocity),
                           points.found_motion.spread.data()};
  thread_local std::vector<OtherBlock> others;
  list_others(number, bodies, step, columns, lanes, pairs, others);
  block.reserve(k_room_near * (end - begin));
  std::uint32_t count = 0;
  for (std::size_t first = 0, last; first < others.size(); first = last) {
    std::uint32_t near_any = 0;
    std::size_t most = 0;
    for (last = first; last < others.size() && others[last].body == others[first].body; ++last) {
      near_any |= others[last].near;
      most += others[last].last - others[last].first;
    }
    for (std::uint32_t few = begin; few < end; ++few) {
      if ((near_any >> (few - begin) & 1) == 0) continue;
      block.reserve(count + most + k_cluster);
      const std::uint32_t before = count;
      for (std::size_t o = first; o < last; ++o)
        if (others[o].near >> (few - begin) & 1)
          count += static_cast<std::uint32_t>(lanes.near_fews(columns, others[o].reach, few, others[o].first,
                                                              others[o].last, block.fews.data() + count,
                                                              block.squares.data() + count));
      if (count > before) block.own.push_back({few, count});
    }
    block.bodies.push_back({others[first].body, static_cast<std::uint32_t>(block.own.size())});
  }
}

/// Pairs of points that may touch, and what finding them needs on the way.
struct PairSearch {
  std::vector<std::uint32_t> scratch, own, other;
};
void make_room(std::vector<std::uint32_t>& list, std::size_t room) {
  if (list.size() < room) list.resize(room);
}

/// Where the pairs of a block with each body are.
void list_bodies(const BlockCandidates& candidates, const NearBlocks& near, const ContactPoints& points,
                 BlockPairs& block) {
  std::uint32_t begin = 0;
  for (const BlockCandidates::OtherBody& other : candidates.bodies) {
    const std::uint32_t behind = points.first[near.blocks.first[other.body + 1]];
    const auto end = static_cast<std::uint32_t>(
        std::partition_point(block.other.begin() + begin,
                             block.other.begin() + static_cast<std::ptrdiff_t>(block.count),
                             [&](std::uint32_t point) { return point < behind; }) -
        block.other.begin());
    if (begin < end) block.bodies.push_back({other.body, begin, end});
    begin = end;
  }
}

/// The pairs of the points of a block with those of later ones: a few of them at a time with all that are
/// near of another body.
void find_pairs(std::size_t number, const PairStep& step, const Execution& execution, ContactPairs& pairs) {
  const PointLanes& lanes = MALLOW_SELECT(execution.level, point_lanes);
  ContactPoints& points = pairs.points;
  BlockPairs& block = pairs.blocks[number];
  block.count = 0;
  block.bodies.clear();
  if (points.first[number] == points.first[number + 1]) return;
  thread_local PairSearch search;
  const FewColumns columns{raw(points.low), raw(points.high), {}, nullptr};
  const BlockCandidates& candidates = pairs.candidates[number];
  std::uint32_t next = 0;
  std::size_t count = 0;
  for (const auto& [few, end] : candidates.own) {
    const std::uint32_t first = std::exchange(next, end);
    const std::size_t room = k_cluster * room_of(end - first);
    make_room(search.scratch, room);
    make_room(search.own, count + room);
    make_room(search.other, count + room);
    count += lanes.near_points(raw(std::as_const(points.position)), columns, few,
                               candidates.fews.data() + first, candidates.squares.data() + first, end - first,
                               search.scratch.data(), search.own.data() + count, search.other.data() + count);
  }
  block.reserve(std::max(room(pairs.near, number), count));
  block.count =
      MALLOW_SELECT(execution.level, contact_lanes)
          .add_pairs(points.rows(), step, search.own.data(), search.other.data(), count, block.columns());
  list_bodies(candidates, pairs.near, points, block);
}

PointPairs point_pairs(const std::vector<std::uint32_t>& of, const BlockPairs& block, std::uint32_t begin,
                       std::uint32_t end, ContactPairs& pairs) {
  const RoundColumns round = pairs.round(block);
  return {of.data(), round.acts, round.impulses, begin, end};
}

/// In which pairs the points of a block are.
void find_sides(std::size_t number, ContactPairs& pairs) {
  const std::vector<RangeBlocks::Block>& blocks = pairs.near.blocks.blocks;
  BlockSides& sides = pairs.sides[number];
  const BlockPairs& own = pairs.blocks[number];
  sides.own = point_pairs(own.own, own, 0, static_cast<std::uint32_t>(own.count), pairs);
  sides.earlier.clear();
  for (const NearBlocks::Other& other : pairs.near.others[number]) {
    if (other.block > number) break;
    const BlockPairs& block = pairs.blocks[other.block];
    for (const BlockPairs::OtherBody& with : block.bodies)
      if (with.body == blocks[number].range)
        sides.earlier.push_back(point_pairs(block.other, block, with.begin, with.end, pairs));
  }
}

/// Numbers the pairs of all blocks, whole words of bits for each. Returns how many numbers there are.
std::size_t number_pairs(ContactPairs& pairs) {
  std::size_t count = 0;
  for (BlockPairs& block : pairs.blocks) {
    block.first = count;
    count += (block.count + k_word - 1) / k_word * k_word;
  }
  pairs.acts.resize_unset(count / k_word);
  pairs.closing.resize_unset(count);
  pairs.impulses.resize_unset(4 * count);
  pairs.sums.resize_unset(pairs.keeps_sums ? 4 * count : 0);
  std::fill_n(pairs.sums.data(), pairs.sums.size(), 0.0f);
  pairs.shares.resize_unset(pairs.points.size());
  return count;
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
  return own.capacity() * (2 * sizeof(std::uint32_t) + 6 * sizeof(float)) +
         bodies.capacity() * sizeof(OtherBody);
}

void BlockCandidates::clear() {
  own.clear();
  bodies.clear();
}

void BlockCandidates::reserve(std::size_t fews_near) {
  if (fews.size() >= fews_near) return;
  fews.resize(fews_near);
  squares.resize(fews_near);
}

std::size_t BlockCandidates::bytes() const {
  return fews.capacity() * sizeof(std::uint32_t) + squares.capacity() * sizeof(float) +
         own.capacity() * sizeof(OwnFew) + bodies.capacity() * sizeof(OtherBody);
}

RoundColumns ContactPairs::round(const BlockPairs& block) {
  const std::size_t k = block.first;
  return {
      acts.data() + k / k_word, {closing.x() + k, closing.y() + k, closing.z() + k}, impulses.data() + 4 * k};
}

TouchingPoints ContactPairs::touching(std::size_t block) const {
  return {points.first[block], points.first[block + 1], sides[block].own, sides[block].earlier.data(),
          sides[block].earlier.size()};
}

std::size_t ContactPairs::bytes() const {
  std::size_t sum = near.bytes() + points.bytes() + closing.bytes() + acts.bytes();
  for (const Column<float>* column : {&impulses, &shares, &sums}) sum += column->bytes();
  for (const BlockPairs& block : blocks) sum += block.bytes();
  for (const BlockCandidates& block : candidates) sum += block.bytes();
  for (const BlockSides& block : sides) sum += block.earlier.capacity() * sizeof(PointPairs);
  return sum;
}

bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs) {
  ContactPoints& points = pairs.points;
  bool anew = find_near_blocks(positions, velocities, bodies, step, execution, pairs.near);
  if (anew) place_points(positions, pin, bodies, pairs.near, execution, points);
  if (points.empty()) return false;
  move_points(velocities, pairs.near, execution, points);
  if (anew || !are_as_found(points)) {
    anew = true;
    std::swap(points.motion, points.found_motion);
    if (step.slack > 0)
      for (float& spread : points.found_motion.spread) spread += step.slack;
  }
  pairs.blocks.resize(pairs.near.blocks.blocks.size());
  pairs.candidates.resize(pairs.blocks.size());
  pairs.sides.resize(pairs.blocks.size());
  const PairStep pair_step{step.time_step, step.max_push, pushed_together(step)};
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    if (anew) find_near_fews(number, bodies, step, MALLOW_SELECT(execution.level, point_lanes), pairs);
    find_pairs(number, pair_step, execution, pairs);
  });
  if (number_pairs(pairs) == 0) return false;
  parallel_for(execution.threads, pairs.near.blocks,
               [&](const RangeBlocks::Block&, std::size_t number) { find_sides(number, pairs); });
  return true;
}

}  // namespace mallow

#include "contact/contact_pairs.h"

#include <algorithm>
#include <array>
#include <span>
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
std::size_t room_of_pairs(const NearBlocks& near, std::size_t number) {
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

/// Some fews, side by side, and which they are.
struct FewList {
  std::vector<std::uint32_t> few;
  std::array<std::vector<float>, 10> columns;

  void reserve(std::size_t room) {
    if (few.size() >= room) return;
    few.resize(room);
    for (std::vector<float>& column : columns) column.resize(room);
  }
  FewColumns from(std::size_t first) {
    const auto at = [&](std::size_t k) { return columns[k].data() + first; };
    return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, {at(6), at(7), at(8)}, at(9)};
  }
};

/// The fews of a body's later blocks that a block may touch.
struct OtherBody {
  std::uint32_t near = 0;  ///< a bit for each few of the block that is near them
  std::size_t count = 0;
  FewList fews;
};

/// others: of one body.
void list_fews(std::size_t number, std::span<const NearBlocks::Other> others, const FewColumns& fews,
               const PointLanes& lanes, const ContactPairs& pairs, OtherBody& body) {
  const ContactPoints& points = pairs.points;
  const std::vector<Moving>& motion = pairs.near.block_motion;
  body.near = 0;
  body.count = 0;
  for (const auto& [other, reach] : others) {
    const std::uint32_t near = lanes.fews_in_box(fews, points.first_few(number), points.first_few(number + 1),
                                                 lane_box(motion[other].box, reach));
    if (near == 0) continue;
    body.near |= near;
    body.fews.reserve(body.count + k_most_points / k_cluster + k_cluster);
    body.count += lanes.list_fews(fews, points.first_few(other), points.first_few(other + 1),
                                  lane_box(motion[number].box, reach), body.fews.few.data() + body.count,
                                  body.fews.from(body.count));
  }
}

/// Fews of later blocks of other bodies near each of a block.
void find_near_fews(std::size_t number, const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                    const PointLanes& lanes, ContactPairs& pairs) {
  const std::vector<RangeBlocks::Block>& blocks = pairs.near.blocks.blocks;
  ContactPoints& points = pairs.points;
  BlockCandidates& block = pairs.candidates[number];
  block.bodies.clear();
  block.own_count = 0;
  const FewColumns columns{raw(points.low), raw(points.high), raw(points.found_motion.velocity),
                           points.found_motion.spread.data()};
  const std::span<const NearBlocks::Other> others = pairs.near.others[number];
  if (others.empty()) return;
  constexpr std::size_t k_most_own = k_most_points / k_cluster;
  block.reserve(k_room_near * k_most_own);
  std::uint32_t count = 0;
  const auto of = [&](const NearBlocks::Other& other) { return blocks[other.block].range; };
  auto first = std::ranges::upper_bound(others, number, {}, &NearBlocks::Other::block);
  for (auto last = first; first != others.end(); first = last) {
    while (last != others.end() && of(*last) == of(*first)) ++last;
    thread_local OtherBody body;
    list_fews(number, {first, last}, columns, lanes, pairs, body);
    if (body.count == 0) continue;
    const float spacing = 0.5f * (bodies[blocks[number].range].spacing + bodies[of(*first)].spacing);
    const FewReach reach{.time_step = step.time_step,
                         .across = k_across * spacing,
                         .along = spacing + pushed_together(step),
                         .most = step.reach};
    block.reserve(count + k_most_own * body.count + k_cluster);
    if (block.own.size() < block.own_count + k_most_own) block.own.resize(block.own_count + k_most_own);
    const std::size_t found = lanes.near_fews(
        columns, points.first_few(number), body.near, reach, body.fews.from(0), body.fews.few.data(),
        body.count, count, block.fews.data(), block.squares.data(), block.own.data() + block.own_count);
    if (found == 0) continue;
    block.own_count += found;
    count = block.own[block.own_count - 1].end;
    block.bodies.push_back(of(*first));
  }
}

/// Pairs of points that may touch, and what finding them needs on the way.
struct PairSearch {
  std::vector<std::uint32_t> scratch, own, other;
};

/// Where the pairs of a block with each body are.
void list_bodies(const BlockCandidates& candidates, const NearBlocks& near, const ContactPoints& points,
                 BlockPairs& block) {
  const std::span<const std::uint32_t> others(block.other.data(), block.count);
  std::uint32_t begin = 0;
  for (const std::uint32_t body : candidates.bodies) {
    const std::uint32_t behind = points.first[near.blocks.first[body + 1]];
    const auto found = std::ranges::partition_point(others.subspan(begin),
                                                    [&](std::uint32_t point) { return point < behind; });
    const auto end = static_cast<std::uint32_t>(found - others.subspan(begin).begin()) + begin;
    if (begin < end) block.bodies.push_back({body, begin, end});
    begin = end;
  }
}

/// The pairs of the points of a block with those of later ones.
void find_pairs(std::size_t number, const PairStep& step, const Execution& execution, ContactPairs& pairs) {
  ContactPoints& points = pairs.points;
  BlockPairs& block = pairs.blocks[number];
  block.count = 0;
  block.bodies.clear();
  const BlockCandidates& candidates = pairs.candidates[number];
  const std::size_t fews = candidates.own_count;
  if (fews == 0) return;
  thread_local PairSearch search;
  const std::size_t room = k_cluster * room_of(candidates.own[fews - 1].end);
  for (std::vector<std::uint32_t>* list : {&search.scratch, &search.own, &search.other})
    if (list->size() < room) list->resize(room);
  const std::size_t count =
      MALLOW_SELECT(execution.level, point_lanes)
          .near_points(raw(std::as_const(points.position)), {raw(points.low), raw(points.high), {}, nullptr},
                       candidates.own.data(), fews, candidates.fews.data(), candidates.squares.data(),
                       search.scratch.data(), search.own.data(), search.other.data());
  block.reserve(std::max(room_of_pairs(pairs.near, number), count));
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
  pairs.acting.resize(pairs.blocks.size());
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

void BlockCandidates::reserve(std::size_t fews_near) {
  if (fews.size() >= fews_near) return;
  fews.resize(fews_near);
  squares.resize(fews_near);
}

std::size_t BlockCandidates::bytes() const {
  return fews.capacity() * sizeof(std::uint32_t) + squares.capacity() * sizeof(float) +
         own.capacity() * sizeof(OwnFew) + bodies.capacity() * sizeof(std::uint32_t);
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

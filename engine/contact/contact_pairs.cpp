#include "contact/contact_pairs.h"

#include <algorithm>
#include <array>
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

/// Fews of later blocks of other bodies near each of a block.
void find_near_fews(std::size_t number, const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                    const PointLanes& lanes, ContactPairs& pairs) {
  const NearBlocks& near = pairs.near;
  ContactPoints& points = pairs.points;
  BlockCandidates& block = pairs.candidates[number];
  block.ends.clear();
  const std::size_t begin = points.first_few(number), end = points.first_few(number + 1);
  if (begin == end) return;
  const FewColumns columns{raw(points.low), raw(points.high), raw(points.found_motion.velocity),
                           points.found_motion.spread.data()};
  struct Other {
    FewReach reach;
    std::size_t first, last;  ///< fews
    std::uint32_t near;       ///< a bit for each of the block that is near them
  };
  thread_local std::vector<Other> others;
  others.clear();
  std::size_t most = 0;
  for (const auto& [other, reach] : near.others[number]) {
    if (other < number) continue;
    const float spacing = 0.5f * (bodies[near.blocks.blocks[number].range].spacing +
                                  bodies[near.blocks.blocks[other].range].spacing);
    const Aabb& box = near.block_motion[other].box;
    const Vec3 low = box.min.array() - reach, high = box.max.array() + reach;
    others.push_back({{.time_step = step.time_step,
                       .across = k_across * spacing,
                       .along = spacing + pushed_together(step),
                       .most = step.reach},
                      points.first_few(other),
                      points.first_few(other + 1),
                      lanes.fews_in_box(columns, begin, end, low.data(), high.data())});
    most += others.back().last - others.back().first;
  }
  block.ends.reserve(k_block / k_cluster);
  std::uint32_t count = 0;
  for (std::size_t few = begin; few < end; ++few) {
    block.reserve(std::max(count + most + k_cluster, k_room_near * (end - begin)));
    for (const Other& other : others)
      if (other.near >> (few - begin) & 1)
        count += static_cast<std::uint32_t>(lanes.near_fews(columns, other.reach, few, other.first,
                                                            other.last, block.fews.data() + count,
                                                            block.squares.data() + count));
    block.ends.push_back(count);
  }
}

/// What finding the pairs of a block needs on the way.
struct PairSearch {
  std::vector<std::uint32_t> scratch, own, other;
};
void make_room(std::vector<std::uint32_t>& list, std::size_t room) {
  if (list.size() < room) list.resize(room);
}

/// The pairs of the points of a block with those of later ones: a few of them at a time with all fews near.
void find_pairs(std::size_t number, const PairStep& step, const Execution& execution, ContactPairs& pairs) {
  const PointLanes& lanes = MALLOW_SELECT(execution.level, point_lanes);
  ContactPoints& points = pairs.points;
  const std::size_t begin = points.first_few(number), end = points.first_few(number + 1);
  BlockPairs& block = pairs.blocks[number];
  block.count = 0;
  pairs.sides[number].points.clear();
  if (begin == end) return;
  thread_local PairSearch search;
  const FewColumns columns{raw(points.low), raw(points.high), {}, nullptr};
  const BlockCandidates& candidates = pairs.candidates[number];
  std::uint32_t next = 0;
  std::size_t count = 0;
  for (std::size_t few = begin; few < end; ++few) {
    const std::uint32_t first = std::exchange(next, candidates.ends[few - begin]);
    if (first == next) continue;
    const std::size_t room = k_cluster * room_of(next - first);
    make_room(search.scratch, room);
    make_room(search.own, count + room);
    make_room(search.other, count + room);
    count +=
        lanes.near_points(raw(std::as_const(points.position)), columns, few, candidates.fews.data() + first,
                          candidates.squares.data() + first, next - first, search.scratch.data(),
                          search.own.data() + count, search.other.data() + count);
  }
  block.reserve(std::max(room(pairs.near, number), count));
  block.count =
      MALLOW_SELECT(execution.level, contact_lanes)
          .add_pairs(points.rows(), step, search.own.data(), search.other.data(), count, block.columns());
}

/// In which pairs the points of a block are.
void find_sides(std::uint32_t number, const ContactLanes& lanes, ContactPairs& pairs) {
  struct Found {
    std::vector<std::uint32_t> point, pair;
    std::size_t count = 0;
  };
  thread_local Found found;
  const NearBlocks& near = pairs.near;
  const std::uint32_t begin = pairs.points.first[number], end = pairs.points.first[number + 1];
  if (begin == end) return;
  // As the second.
  found.count = 0;
  for (const NearBlocks::Other& other : near.others[number]) {
    if (other.block > number) break;
    const BlockPairs& of = pairs.blocks[other.block];
    const std::size_t most = found.count + of.count + k_cluster;
    if (found.point.size() < most) {
      found.point.resize(most);
      found.pair.resize(most);
    }
    found.count +=
        lanes.find_points(of.other.data(), of.count, begin, end, static_cast<std::uint32_t>(of.first),
                          found.pair.data() + found.count, found.point.data() + found.count);
  }
  std::array<std::uint32_t, k_block> seconds{}, firsts{};
  for (std::size_t k = 0; k < found.count; ++k) ++seconds[found.point[k]];
  const BlockPairs& own = pairs.blocks[number];
  for (std::size_t k = 0; k < own.count; ++k) ++firsts[own.own[k] - begin];

  BlockSides& block = pairs.sides[number];
  block.points.reserve(end - begin);
  auto pair = static_cast<std::uint32_t>(own.first);
  std::uint32_t place = 0;
  for (std::uint32_t p = 0; p < end - begin; ++p) {
    if (firsts[p] + seconds[p] == 0) continue;
    const std::uint32_t first = std::exchange(pair, pair + firsts[p]);
    const std::uint32_t of_others = std::exchange(place, place + seconds[p]);
    block.points.push_back({begin + p, first, pair, place});
    seconds[p] = of_others;
  }
  if (block.others.size() < place) block.others.resize(std::max<std::size_t>(place, 2 * room(near, number)));
  for (std::size_t k = 0; k < found.count; ++k) block.others[seconds[found.point[k]]++] = found.pair[k];
}

/// Numbers the pairs of all blocks; lanes write whole clusters, and a few beyond. Returns how many numbers
/// there are.
std::size_t number_pairs(ContactPairs& pairs) {
  std::size_t count = 0;
  for (BlockPairs& block : pairs.blocks) {
    block.first = count;
    if (block.count > 0) count += (block.count + 3 + k_cluster - 1) / k_cluster * k_cluster;
  }
  for (Column<float>* column : {&pairs.acts, &pairs.own_share, &pairs.other_share})
    column->resize_unset(count);
  pairs.closing.resize_unset(count);
  pairs.impulses.resize_unset(4 * count);
  pairs.sums.resize_unset(pairs.keeps_sums ? 4 * count : 0);
  std::fill_n(pairs.sums.data(), pairs.sums.size(), 0.0f);
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
  return own.capacity() * (2 * sizeof(std::uint32_t) + 6 * sizeof(float));
}

void BlockCandidates::reserve(std::size_t room) {
  if (fews.size() >= room) return;
  fews.resize(room);
  squares.resize(room);
}

std::size_t BlockCandidates::bytes() const {
  return fews.capacity() * sizeof(std::uint32_t) + squares.capacity() * sizeof(float) +
         ends.capacity() * sizeof(std::uint32_t);
}

RoundColumns ContactPairs::round(std::size_t pair) {
  return {acts.data() + pair,
          {closing.x() + pair, closing.y() + pair, closing.z() + pair},
          own_share.data() + pair,
          other_share.data() + pair,
          impulses.data() + 4 * pair};
}

std::size_t ContactPairs::bytes() const {
  std::size_t sum = near.bytes() + points.bytes() + closing.bytes();
  for (const Column<float>* column : {&acts, &own_share, &other_share, &impulses, &sums})
    sum += column->bytes();
  for (const BlockPairs& block : blocks) sum += block.bytes();
  for (const BlockCandidates& block : candidates) sum += block.bytes();
  for (const BlockSides& block : sides)
    sum += block.points.capacity() * sizeof(TouchingPoint) + block.others.capacity() * sizeof(std::uint32_t);
  return sum;
}

bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs) {
  ContactPoints& points = pairs.points;
  bool anew = find_near_blocks(positions, velocities, bodies, step, execution, pairs.near);
  if (anew) place_points(positions, pin, bodies, pairs.near, execution, points);
  if (points.empty()) return false;
  move_points(velocities, bodies, pairs.near, execution, points);
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
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    find_sides(static_cast<std::uint32_t>(number), MALLOW_SELECT(execution.level, contact_lanes), pairs);
  });
  return true;
}

}  // namespace mallow

#include "contact/body_contact.h"

#include <algorithm>
#include <span>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Rounds of impulses in a step: as many as it takes until no pair would be nearer than it may by more than a
/// share of its spacing. What rests takes the least.
constexpr int k_least_rounds = 4, k_most_rounds = 8;
constexpr float k_tolerance = 0.01f;

/// Calls body(block, its number) for every block that has points.
template <class Body>
void for_blocks(const Execution& execution, const ContactPairs& pairs, const Body& body) {
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    if (pairs.points.first[number] < pairs.points.first[number + 1]) body(number);
  });
}

/// Which pairs come nearer than they may, or stick. Returns the most by which one misses its target.
float find_acting(const Execution& execution, const ContactLanes& lanes, ContactPairs& pairs) {
  pairs.partial_miss.assign(pairs.blocks.size(), 0);
  for_blocks(execution, pairs, [&](std::size_t number) {
    BlockPairs& block = pairs.blocks[number];
    pairs.partial_miss[number] =
        lanes.acting(pairs.points.velocity.data(), block.columns(), block.count, pairs.round(block.first));
  });
  return std::ranges::max(pairs.partial_miss);
}

/// One round of impulses. Each particle shares its mass between its pairs that act, so that all of them
/// together do not overshoot.
void push_apart(const Execution& execution, const ContactLanes& lanes, ContactPairs& pairs) {
  const float* const matter = pairs.points.matter.data();
  float* const velocities = pairs.points.velocity.data();
  for_blocks(execution, pairs, [&](std::size_t number) {
    lanes.share(pairs.sides[number].touching(), matter, pairs.round(0), velocities);
  });
  for_blocks(execution, pairs, [&](std::size_t number) {
    BlockPairs& block = pairs.blocks[number];
    lanes.impulses(block.columns(), block.count, pairs.round(block.first));
    if (pairs.sums.size() == 0) return;
    for (std::size_t k = 4 * block.first; k < 4 * (block.first + block.count); ++k)
      pairs.sums.data()[k] += pairs.impulses.data()[k];
  });
  for_blocks(execution, pairs, [&](std::size_t number) {
    lanes.push(pairs.sides[number].touching(), matter, pairs.impulses.data(), velocities);
  });
}

}  // namespace

void resolve_body_contacts(const VectorColumn& positions, const std::uint16_t* pin,
                           const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                           const Execution& execution, VectorColumn& velocities, ContactPairs& pairs) {
  if (!find_contact_pairs(positions, velocities, pin, bodies, step, execution, pairs)) return;
  const ContactLanes& lanes = MALLOW_SELECT(execution.level, contact_lanes);
  const float tolerance = k_tolerance * std::ranges::min(bodies, {}, &TouchingBody::spacing).spacing;
  for (int round = 0; round < k_most_rounds; ++round) {
    const float excess = step.time_step * find_acting(execution, lanes, pairs);
    if (excess == 0 || (round >= k_least_rounds && excess < tolerance)) break;
    push_apart(execution, lanes, pairs);
  }
  const ContactPoints& points = pairs.points;
  for_blocks(execution, pairs, [&](std::size_t number) {
    for (const TouchingPoint& touching : pairs.sides[number].points)
      if (points.inverse_mass(touching.point) > 0)
        velocities.set(points.row[touching.point], points.velocity_of(touching.point));
  });
}

void list_touches(const VectorColumn& before, const ContactPairs& pairs, std::vector<BodyTouch>& touches) {
  const ContactPoints& points = pairs.points;
  if (points.empty() || pairs.sums.size() == 0) return;
  const std::vector<RangeBlocks::Block>& blocks = pairs.near.blocks.blocks;
  for (std::size_t number = 0; number < pairs.blocks.size(); ++number) {
    const BlockPairs& block = pairs.blocks[number];
    const std::size_t first = touches.size();
    std::size_t other_block = 0;
    for (std::size_t k = 0; k < block.count; ++k) {
      const auto got = Eigen::Map<const Vec3>(pairs.sums.data() + 4 * (block.first + k));
      if (got.isZero(0)) continue;
      const std::uint32_t i = block.own[k], j = block.other[k];
      if (j < points.first[other_block] || j >= points.first[other_block + 1])
        other_block = static_cast<std::size_t>(std::upper_bound(points.first.begin(), points.first.end(), j) -
                                               points.first.begin() - 1);
      const std::uint32_t other = blocks[other_block].range;
      auto touch = std::find_if(touches.begin() + static_cast<std::ptrdiff_t>(first), touches.end(),
                                [&](const BodyTouch& known) { return known.other == other; });
      if (touch == touches.end()) touch = touches.insert(touch, {blocks[number].range, other, {}});
      const Vec3 v = before.get(points.row[i]) - before.get(points.row[j]);
      const Eigen::Vector3d normal(block.normal_x[k], block.normal_y[k], block.normal_z[k]);
      touch->sums.add_between(got.cast<double>(), points.position.get(i).cast<double>(),
                              points.position.get(j).cast<double>(), v.cast<double>(), normal);
    }
  }
}

}  // namespace mallow

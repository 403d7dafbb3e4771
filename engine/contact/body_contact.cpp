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

/// Calls body(point, its sides) for all of a block that have any.
template <class Body>
void for_touching(const BlockSides& block, const Body& body) {
  std::uint32_t first = 0;
  for (const auto& [point, end] : block.points) {
    body(point, std::span(block.sides).subspan(first, end - first));
    first = end;
  }
}

/// Which pairs come nearer than they may, or stick. Returns the most by which one misses its target.
float find_acting(const Execution& execution, const ContactLanes& lanes, ContactPairs& pairs) {
  pairs.partial_miss.assign(pairs.blocks.size(), 0);
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    BlockPairs& block = pairs.blocks[number];
    pairs.partial_miss[number] =
        lanes.acting(pairs.rows().velocities, block.columns(), block.count, pairs.acts.data() + block.first);
  });
  return std::ranges::max(pairs.partial_miss);
}

/// One round of impulses. Each particle shares its mass between its pairs that act, so that all of them
/// together do not overshoot.
void push_apart(const Execution& execution, const ContactLanes& lanes, ContactPairs& pairs) {
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    for_touching(pairs.sides[number], [&](std::uint32_t i, std::span<const BlockSides::Side> sides) {
      float acting = 0;
      for (const BlockSides::Side& side : sides) acting += pairs.acts[side.pair];
      pairs.velocity[i].share = acting * pairs.points[i].inverse_mass;
    });
  });
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    BlockPairs& block = pairs.blocks[number];
    lanes.impulses(pairs.rows().velocities, block.columns(), block.count, pairs.acts.data() + block.first,
                   pairs.impulses.data() + 4 * block.first);
    if (pairs.sums.size() == 0) return;
    for (std::size_t k = 4 * block.first; k < 4 * (block.first + block.count); ++k)
      pairs.sums.data()[k] += pairs.impulses.data()[k];
  });
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    for_touching(pairs.sides[number], [&](std::uint32_t i, std::span<const BlockSides::Side> sides) {
      if (pairs.velocity[i].share == 0) return;
      Eigen::Vector4f sum = Eigen::Vector4f::Zero();
      for (const auto& [pair, sign] : sides)
        sum += sign * Eigen::Map<const Eigen::Vector4f>(pairs.impulses.data() + 4 * pair);
      pairs.velocity[i].velocity += pairs.points[i].inverse_mass * sum.head<3>();
    });
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
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    for (const auto& [point, end] : pairs.sides[number].points)
      if (pairs.points[point].inverse_mass > 0)
        velocities.set(pairs.near.row[point], pairs.velocity[point].velocity);
  });
}

void list_touches(const VectorColumn& before, const ContactPairs& pairs, std::vector<BodyTouch>& touches) {
  const NearBlocks& near = pairs.near;
  if (near.row.empty() || pairs.sums.size() == 0) return;
  const std::vector<RangeBlocks::Block>& blocks = near.blocks.blocks;
  for (std::size_t number = 0; number < pairs.blocks.size(); ++number) {
    const BlockPairs& block = pairs.blocks[number];
    const std::size_t first = touches.size();
    std::size_t other_block = 0;
    for (std::size_t k = 0; k < block.count; ++k) {
      const auto got = Eigen::Map<const Vec3>(pairs.sums.data() + 4 * (block.first + k));
      if (got.isZero(0)) continue;
      const std::uint32_t i = block.own[k], j = block.other[k];
      if (j < near.first_point[other_block] || j >= near.first_point[other_block + 1])
        other_block = static_cast<std::size_t>(
            std::upper_bound(near.first_point.data(), near.first_point.data() + blocks.size() + 1, j) -
            near.first_point.data() - 1);
      const std::uint32_t other = blocks[other_block].range;
      auto touch = std::find_if(touches.begin() + static_cast<std::ptrdiff_t>(first), touches.end(),
                                [&](const BodyTouch& known) { return known.other == other; });
      if (touch == touches.end()) touch = touches.insert(touch, {blocks[number].range, other, {}});
      const Vec3 v = before.get(near.row[i]) - before.get(near.row[j]);
      const Eigen::Vector3d normal(block.normal_x[k], block.normal_y[k], block.normal_z[k]);
      touch->sums.add_between(got.cast<double>(), pairs.points[i].position.cast<double>(),
                              pairs.points[j].position.cast<double>(), v.cast<double>(), normal);
    }
  }
}

}  // namespace mallow

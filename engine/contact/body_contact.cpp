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
    pairs.partial_miss[number] = lanes.acting(pairs.rows().velocities, block.columns(), block.count,
                                              pairs.acts.data() + block.first);
  });
  return std::ranges::max(pairs.partial_miss);
}

/// One round of impulses. Each particle shares its mass between its pairs that act, so that all of them together
/// do not overshoot.
void push_apart(const Execution& execution, const ContactLanes& lanes, ContactPairs& pairs) {
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    for_touching(pairs.sides[number], [&](std::uint32_t i, std::span<const BlockSides::Side> sides) {
      float acting = 0;
      for (const BlockSides::Side& side : sides) acting += pairs.acts[side.pair];
      pairs.shared_velocity[i] = {pairs.velocity[i].velocity, acting * pairs.points[i].inverse_mass};
    });
  });
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    BlockPairs& block = pairs.blocks[number];
    lanes.impulses(pairs.shared_velocity.front().velocity.data(), block.columns(), block.count,
                   pairs.acts.data() + block.first, pairs.impulses.data() + 4 * block.first);
  });
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    for_touching(pairs.sides[number], [&](std::uint32_t i, std::span<const BlockSides::Side> sides) {
      if (pairs.shared_velocity[i].share == 0) return;
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

}  // namespace mallow

#include "contact/body_contact.h"

#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Rounds of impulses in a step: as many as it takes until no pair would be nearer than it may by more than a
/// share of its spacing. What rests takes the least.
constexpr int k_least_rounds = 4, k_most_rounds = 8;
constexpr float k_tolerance = 0.01f;

/// Calls body(number) for every block that has points.
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
        lanes.acting(pairs.points.velocity.data(), block.columns(), block.count, pairs.round(block));
  });
  return std::ranges::max(pairs.partial_miss);
}

/// Adds what the pairs of a block got in a round.
void add_impulses(const BlockPairs& block, ContactPairs& pairs) {
  for (std::size_t k = block.first; k < block.first + block.count; ++k)
    if (pairs.acts[k / k_word] >> (k % k_word) & 1)
      for (std::size_t a = 4 * k; a < 4 * k + 3; ++a) pairs.sums[a] += pairs.impulses[a];
}

/// One round of impulses. Each particle shares its mass between its pairs that act, so that all of them
/// together do not overshoot.
void push_apart(const Execution& execution, const ContactLanes& lanes, ContactPairs& pairs) {
  const float* const inverse_mass = pairs.points.inverse_mass.data();
  float* const shares = pairs.shares.data();
  for_blocks(execution, pairs, [&](std::size_t number) {
    pairs.acting[number] = lanes.share(pairs.touching(number), inverse_mass, shares);
  });
  for_blocks(execution, pairs, [&](std::size_t number) {
    BlockPairs& block = pairs.blocks[number];
    lanes.impulses(block.columns(), block.count, shares, pairs.round(block));
    if (!pairs.sums.empty()) add_impulses(block, pairs);
  });
  for_blocks(execution, pairs, [&](std::size_t number) {
    if (const std::uint32_t acting = pairs.acting[number])
      lanes.push(pairs.touching(number), acting, inverse_mass, shares, pairs.points.velocity.data());
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
  return_points(pairs.points, pairs.near, execution, velocities);
}

void list_touches(const VectorColumn& before, const ContactPairs& pairs, std::vector<BodyTouch>& touches) {
  const ContactPoints& points = pairs.points;
  if (points.empty() || pairs.sums.empty()) return;
  const NearBlocks& near = pairs.near;
  const auto velocity = [&](std::size_t block, std::uint32_t point) {
    return before.get(points.first_row[block] + (point - points.first[block]));
  };
  for (std::size_t number = 0; number < pairs.blocks.size(); ++number) {
    const BlockPairs& block = pairs.blocks[number];
    for (const auto& [body, begin, end] : block.bodies) {
      BodyTouch touch{near.blocks.blocks[number].range, body, {}};
      bool any = false;
      std::size_t other_block = near.blocks.first[body];
      for (std::size_t k = begin; k < end; ++k) {
        const auto got = Eigen::Map<const Vec3>(pairs.sums.data() + 4 * (block.first + k));
        if (got.isZero(0)) continue;
        any = true;
        const std::uint32_t i = block.own[k], j = block.other[k];
        if (j < points.first[other_block] || j >= points.first[other_block + 1])
          other_block = static_cast<std::size_t>(
              std::upper_bound(points.first.begin(), points.first.end(), j) - points.first.begin() - 1);
        const Vec3 v = velocity(number, i) - velocity(other_block, j);
        const Eigen::Vector3d normal(block.normal_x[k], block.normal_y[k], block.normal_z[k]);
        touch.sums.add_between(got.cast<double>(), points.position.get(i).cast<double>(),
                               points.position.get(j).cast<double>(), v.cast<double>(), normal);
      }
      if (any) touches.push_back(touch);
    }
  }
}

}  // namespace mallow

#include "contact/body_contact.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Rounds of impulses in a step: as many as it takes until no pair would be nearer than it may by more than a
/// share of its spacing. What rests takes the least.
constexpr int k_least_rounds = 4, k_most_rounds = 8;
constexpr float k_tolerance = 0.01f;

/// Calls body(point, its pairs) for all of a block that have any.
template <class Block, class Body>
void for_touching(Block& block, const Body& body) {
  auto* first = block.pairs.data();
  for (const BlockPairs::Touching& touching : block.points) {
    body(touching.point, std::span(first, touching.count));
    first += touching.count;
  }
}
/// The same for all blocks.
template <class Body>
void for_touching(ContactPairs& pairs, const Threads& threads, const Body& body) {
  parallel_for(threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    for_touching(pairs.blocks[number], body);
  });
}

/// Calls visit(pair, v_i − v_j, its part along n) for the pairs of a point that come nearer than they may, or
/// stick.
template <class Pair, class Visit>
void for_acting_pairs(const ContactPairs& pairs, std::uint32_t i, std::span<Pair> own, const Visit& visit) {
  const Vec3 v = pairs.velocity[i].velocity;
  for (Pair& pair : own) {
    const Vec3 w = v - pairs.velocity[pair.other].velocity;
    const float along = w.dot(pair.normal);
    if (along < pair.target || pair.sticks > 0) visit(pair, w, along);
  }
}

/// How many pairs of each point act. Returns the most by which one would be too near, or too far where it
/// sticks, in its spacing.
float count_pushes(const Threads& threads, float time_step, ContactPairs& pairs) {
  pairs.partial_excess.assign(pairs.blocks.size(), 0);
  parallel_for(threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    float most = 0;
    for_touching(pairs.blocks[number], [&](std::uint32_t i, std::span<ContactPair> own) {
      float pushes = 0;
      for_acting_pairs(pairs, i, own, [&](const ContactPair& pair, const Vec3&, float along) {
        ++pushes;
        most = std::max(most, std::abs(pair.target - along) / pairs.points[i].half_spacing);
      });
      pairs.velocity[i].pushes = pushes;
    });
    pairs.partial_excess[number] = most;
  });
  return 0.5f * time_step * std::ranges::max(pairs.partial_excess);
}

/// What its pairs do to the velocity of a point in one round. A particle shares its mass between its pairs,
/// so that all of them together do not overshoot. What sticks is held back by no more than is left of that.
/// got: where the impulse of each pair is added, or null.
Vec3 impulses(const ContactPairs& pairs, std::uint32_t i, std::span<ContactPair> own_pairs, Vec3* got) {
  const ContactPoint& own = pairs.points[i];
  const float own_share = pairs.velocity[i].pushes * own.inverse_mass;
  Vec3 sum = Vec3::Zero();
  for_acting_pairs(pairs, i, own_pairs, [&](ContactPair& pair, const Vec3& w, float along) {
    const ContactPoint& other = pairs.points[pair.other];
    const float mass = 1 / (own_share + pairs.velocity[pair.other].pushes * other.inverse_mass);
    const float friction = own.friction * other.friction;
    const float push = std::max(mass * (pair.target - along), -pair.sticks);
    const Vec3 slip = w - along * pair.normal;
    const float speed = slip.norm();
    const float rub = std::min(friction * (std::max(push, 0.0f) + pair.sticks), mass * speed);
    sum += push * pair.normal;
    if (speed > 0) sum -= rub / speed * slip;
    if (got) {
      Vec3& impulse = got[&pair - own_pairs.data()];
      impulse += push * pair.normal;
      if (speed > 0) impulse -= rub / speed * slip;
    }
    if (pair.sticks > 0) pair.sticks = std::max(0.0f, pair.sticks - std::max(-push, 0.0f));
  });
  return own.inverse_mass * sum;
}

}  // namespace

void resolve_body_contacts(const VectorColumn& positions, const std::uint16_t* pin,
                           const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                           const Execution& execution, VectorColumn& velocities, ContactPairs& pairs) {
  if (!find_contact_pairs(positions, velocities, pin, bodies, step, execution, pairs)) return;
  const Threads& threads = execution.threads;
  for (BlockPairs& block : pairs.blocks) {
    if (pairs.keep_impulses) block.got.reserve(block.pairs.capacity());
    block.got.assign(pairs.keep_impulses ? block.pairs.size() : 0, Vec3::Zero());
  }
  for (int round = 0; round < k_most_rounds; ++round) {
    const float excess = count_pushes(threads, step.time_step, pairs);
    if (excess == 0 || (round >= k_least_rounds && excess < k_tolerance)) break;
    parallel_for(threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
      BlockPairs& block = pairs.blocks[number];
      for_touching(block, [&](std::uint32_t i, std::span<ContactPair> own) {
        const ContactVelocity& now = pairs.velocity[i];
        Vec3* const got = block.got.empty() ? nullptr : &block.got[own.data() - block.pairs.data()];
        pairs.next_velocity[i].velocity = now.velocity;
        if (now.pushes > 0) pairs.next_velocity[i].velocity += impulses(pairs, i, own, got);
      });
    });
    pairs.velocity.swap(pairs.next_velocity);
  }
  for_touching(pairs, threads, [&](std::uint32_t i, std::span<ContactPair>) {
    if (pairs.points[i].inverse_mass > 0) velocities.set(pairs.near.row[i], pairs.velocity[i].velocity);
  });
}

void list_touches(const VectorColumn& before, const ContactPairs& pairs, std::vector<BodyTouch>& touches) {
  const NearBlocks& near = pairs.near;
  if (near.row.empty()) return;
  const std::vector<RangeBlocks::Block>& blocks = near.blocks.blocks;
  for (std::size_t number = 0; number < pairs.blocks.size(); ++number) {
    const BlockPairs& block = pairs.blocks[number];
    if (block.got.empty()) continue;
    const std::uint32_t body = blocks[number].range;
    const std::size_t first = touches.size();
    std::size_t other_block = 0;
    for_touching(block, [&](std::uint32_t i, std::span<const ContactPair> own) {
      for (const ContactPair& pair : own) {
        const Vec3& got = block.got[&pair - block.pairs.data()];
        if (got.isZero(0)) continue;
        if (pair.other < near.first_point[other_block] || pair.other >= near.first_point[other_block + 1])
          other_block = std::ranges::upper_bound(near.first_point, pair.other) - near.first_point.begin() - 1;
        const std::uint32_t other = blocks[other_block].range;
        if (other < body) continue;  // seen from there
        auto touch = std::find_if(touches.begin() + first, touches.end(),
                                  [&](const BodyTouch& known) { return known.other == other; });
        if (touch == touches.end()) touch = touches.insert(touch, {body, other, {}});
        const Vec3 x = 0.5f * (pairs.points[i].position + pairs.points[pair.other].position);
        const Vec3 v = before.get(near.row[i]) - before.get(near.row[pair.other]);
        touch->sums.add(got.cast<double>(), x.cast<double>(), v.cast<double>(), pair.normal.cast<double>());
      }
    });
  }
}

}  // namespace mallow

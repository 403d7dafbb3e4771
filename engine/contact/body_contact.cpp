#include "contact/body_contact.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Points that one thread handles at a time.
constexpr std::size_t k_touching_block = 64;
/// Rounds of impulses in a step: as many as it takes until no pair would be nearer than it may by more than a
/// share of its spacing. What rests takes the least.
constexpr int k_least_rounds = 4, k_most_rounds = 8;
constexpr float k_tolerance = 0.01f;

/// Calls body(point) for all that have a pair.
template <class Body>
void for_touching(const ContactPairs& pairs, const Threads& threads, const Body& body) {
  parallel_for(
      threads, pairs.touching.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) body(pairs.touching[k]);
      },
      k_touching_block);
}

/// Calls visit(pair, v_i − v_j, its part along n) for the pairs of a point that come nearer than they may.
template <class Visit>
void for_pushing_pairs(const ContactPairs& pairs, std::uint32_t i, const Visit& visit) {
  const Vec3 v = pairs.velocity[i].velocity;
  for (std::uint32_t k = pairs.first[i]; k < pairs.first[i + 1]; ++k) {
    const ContactPair& pair = pairs.pairs[k];
    const Vec3 w = v - pairs.velocity[pair.other].velocity;
    const float along = w.dot(pair.normal);
    if (along < pair.target) visit(pair, w, along);
  }
}

/// How many pairs of each point push. Returns the most by which one would be too near, in its spacing.
float count_pushes(const Threads& threads, float time_step, ContactPairs& pairs) {
  pairs.partial_excess.assign((pairs.touching.size() + k_touching_block - 1) / k_touching_block, 0);
  parallel_for(
      threads, pairs.touching.size(),
      [&](std::size_t begin, std::size_t end) {
        float most = 0;
        for (std::size_t k = begin; k < end; ++k) {
          const std::uint32_t i = pairs.touching[k];
          float pushes = 0;
          for_pushing_pairs(pairs, i, [&](const ContactPair& pair, const Vec3&, float along) {
            ++pushes;
            most = std::max(most, (pair.target - along) / pairs.half_spacing[i]);
          });
          pairs.velocity[i].pushes = pushes;
        }
        pairs.partial_excess[begin / k_touching_block] = most;
      },
      k_touching_block);
  return 0.5f * time_step * std::ranges::max(pairs.partial_excess);
}

/// What its pairs do to the velocity of a point in one round. A particle shares its mass between its pairs,
/// so that all of them together do not overshoot.
Vec3 impulses(const ContactPairs& pairs, std::uint32_t i) {
  const ContactPoint& own = pairs.points[i];
  const float own_share = pairs.velocity[i].pushes * own.inverse_mass;
  Vec3 sum = Vec3::Zero();
  for_pushing_pairs(pairs, i, [&](const ContactPair& pair, const Vec3& w, float along) {
    const ContactPoint& other = pairs.points[pair.other];
    const float mass = 1 / (own_share + pairs.velocity[pair.other].pushes * other.inverse_mass);
    const float push = mass * (pair.target - along);
    const Vec3 slip = w - along * pair.normal;
    const float speed = slip.norm();
    sum += push * pair.normal;
    if (speed > 0) sum -= std::min(own.friction * other.friction * push, mass * speed) / speed * slip;
  });
  return own.inverse_mass * sum;
}

}  // namespace

void resolve_body_contacts(const VectorColumn& positions, const std::uint16_t* pin,
                           const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                           const Execution& execution, VectorColumn& velocities, ContactPairs& pairs) {
  if (!find_contact_pairs(positions, velocities, pin, bodies, step, execution, pairs)) return;
  const Threads& threads = execution.threads;
  for (int round = 0; round < k_most_rounds; ++round) {
    const float excess = count_pushes(threads, step.time_step, pairs);
    if (excess == 0 || (round >= k_least_rounds && excess < k_tolerance)) break;
    for_touching(pairs, threads, [&](std::uint32_t i) {
      const ContactVelocity& now = pairs.velocity[i];
      pairs.next_velocity[i].velocity = now.velocity;
      if (now.pushes > 0) pairs.next_velocity[i].velocity += impulses(pairs, i);
    });
    pairs.velocity.swap(pairs.next_velocity);
  }
  for_touching(pairs, threads, [&](std::uint32_t i) {
    if (pairs.points[i].inverse_mass > 0) velocities.set(pairs.row[i], pairs.velocity[i].velocity);
  });
}

}  // namespace mallow

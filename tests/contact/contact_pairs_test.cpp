// Who touches whom in a step: model 2, section 4 C.
#include "contact/contact_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "contact/body_contact.h"

namespace mallow {
namespace contact_pairs_test {

constexpr int k_side = 9;
constexpr float k_time_step = 0.15f;

/// Two cubes that overlap a little, of particles that move in all directions.
struct Cubes {
  VectorColumn position, velocity;
  std::vector<TouchingBody> bodies;
  std::mt19937 random{3};

  Cubes() {
    const auto n = static_cast<std::size_t>(k_side * k_side * k_side);
    position.resize(2 * n);
    velocity.resize(2 * n);
    for (std::size_t b = 0; b < 2; ++b) {
      bodies.push_back({.begin = b * n,
                        .end = (b + 1) * n,
                        .group = static_cast<std::uint32_t>(b),
                        .spacing = 1,
                        .mass = 1,
                        .friction = 0.5f,
                        .adhesion = 0,
                        .sleeps = false,
                        .shape = nullptr});
      for (std::size_t i = 0; i < n; ++i) {
        const auto k = static_cast<int>(i);
        const Vec3 x(Eigen::Vector3i(k % k_side, k / k_side % k_side, k / (k_side * k_side)).cast<float>());
        position.set(b * n + i, x + Vec3(0.4f, 0.3f, 0.9f * k_side) * static_cast<float>(b) + some(0.1f));
        velocity.set(b * n + i, some(1));
      }
    }
  }
  Vec3 some(float most) {
    std::uniform_real_distribution<float> uniform(-most, most);
    return {uniform(random), uniform(random), uniform(random)};
  }
  /// No speed changes by more than twice that.
  void change_velocities(float most) {
    for (std::size_t i = 0; i < velocity.size(); ++i) velocity.set(i, velocity.get(i) + some(most));
  }
  VectorColumn resolved(const BodyContactStep& step, ContactPairs& pairs) const {
    VectorColumn result(velocity.size());
    for (std::size_t i = 0; i < velocity.size(); ++i) result.set(i, velocity.get(i));
    resolve_body_contacts(position, nullptr, bodies, step, {2, best_instruction_level()}, result, pairs);
    return result;
  }
};

TEST(contact_pairs, are_the_same_where_those_who_may_touch_are_not_looked_for_again) {
  constexpr BodyContactStep first{.time_step = k_time_step, .reach = 4, .max_push = 1};
  Cubes cubes;
  ContactPairs kept;
  BodyContactStep step = first;
  step.slack = 0.4f;
  // Little: all that was found stays. Much: it is looked for again.
  for (const float change : {0.0f, 0.1f, 0.1f, 5.0f, 0.1f}) {
    cubes.change_velocities(change);
    const std::vector<Moving> found = kept.near.found_motion;
    const VectorColumn again = cubes.resolved(step, kept);
    step.again = true;
    ContactPairs anew;
    const VectorColumn once = cubes.resolved(first, anew);
    std::size_t count = 0;
    for (std::size_t k = 0; k < anew.blocks.size(); ++k) {
      EXPECT_EQ(kept.blocks[k].count, anew.blocks[k].count) << change;
      count += anew.blocks[k].count;
    }
    EXPECT_GT(count, 50u);
    for (std::size_t i = 0; i < once.size(); ++i) ASSERT_EQ(again.get(i), once.get(i)) << change;
    const bool looked = found.empty() || found[0].velocity != kept.near.found_motion[0].velocity;
    EXPECT_EQ(looked, found.empty() || change > 1) << change;
  }
}

TEST(contact_pairs, are_all_that_come_near_enough_in_the_step_body_by_body_in_the_order_of_rows) {
  constexpr BodyContactStep step{.time_step = k_time_step, .reach = 8, .max_push = 1};
  for (const float speed : {0.0f, 1.0f, 8.0f}) {
    SCOPED_TRACE(speed);
    Cubes cubes;
    cubes.change_velocities(speed);
    // A third of the rows belong to a body of their own, in one group with the second.
    cubes.bodies[1].end = 1200;
    cubes.bodies.push_back(cubes.bodies[1]);
    cubes.bodies.back().begin = 1200;
    cubes.bodies.back().end = cubes.position.size();
    ContactPairs pairs;
    cubes.resolved(step, pairs);
    struct Pair {
      std::size_t body, own, other;
      bool operator==(const Pair&) const = default;
    };
    std::vector<Pair> found, expected;
    const NearBlocks& near = pairs.near;
    for (std::size_t b = 0; b < pairs.blocks.size(); ++b)
      for (const auto& [body, begin, end] : pairs.blocks[b].bodies)
        for (std::size_t k = begin; k < end; ++k) {
          std::size_t other = near.blocks.first[body];
          while (pairs.points.first[other + 1] <= pairs.blocks[b].other[k]) ++other;
          found.push_back(
              {body, pairs.points.first_row[b] + pairs.blocks[b].own[k] - pairs.points.first[b],
               pairs.points.first_row[other] + pairs.blocks[b].other[k] - pairs.points.first[other]});
        }
    for (std::size_t b = 0; b < pairs.blocks.size(); ++b) {
      const RangeBlocks::Block& block = near.blocks.blocks[b];
      const TouchingBody& own = cubes.bodies[block.range];
      for (std::size_t body = block.range + 1; body < cubes.bodies.size(); ++body) {
        if (cubes.bodies[body].group == own.group) continue;
        for (std::size_t i = own.begin + block.begin; i < own.begin + block.end; ++i)
          for (std::size_t j = cubes.bodies[body].begin; j < cubes.bodies[body].end; ++j) {
            const float most =
                k_time_step * (cubes.velocity.get(i) - cubes.velocity.get(j)).norm() + pushed_together(step);
            const float gap = (cubes.position.get(i) - cubes.position.get(j)).norm() - 1;
            ASSERT_GT(std::abs(gap - most), 1e-6f);  // no pair is told by how it was rounded
            if (gap <= most) expected.push_back({body, i, j});
          }
      }
    }
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(found.size(), expected.size());
    EXPECT_TRUE(found == expected);
  }
}

}  // namespace contact_pairs_test
}  // namespace mallow

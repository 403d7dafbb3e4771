// Who touches whom in a step: model 2, section 4 C.
#include "contact/contact_pairs.h"

#include <gtest/gtest.h>

#include <random>

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

}  // namespace contact_pairs_test
}  // namespace mallow

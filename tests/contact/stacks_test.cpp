// Bodies that rest on each other where more is asked than of two alike cubes that nothing moves: another
// alpha, spacings that differ, steps of odd lengths, colliders that move, bodies that yield.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "contact/cubes.h"

namespace mallow {
namespace stacks_test {

using namespace contact_tests;

/// One cube on another, as many above each other as there are heights.
void stack(Simulation& s, const Material& material, std::initializer_list<float> heights) {
  for (const float height : heights) s.add_body(box({6, 6, 6}, {-3, -3, height}), material);
}
bool all_sleep(const Simulation& s) {
  return std::ranges::none_of(s.bodies(), [&](BodyId body) { return s.is_awake(body); });
}
/// Runs until all bodies sleep, or to a time [s].
void settle(Simulation& s, double end) {
  while (s.time() < end && !(s.time() > 0 && all_sleep(s))) s.step();
}

// Centres are lower than at alpha 0, as springs are a third as stiff.
TEST(stacks, of_four_free_cubes_do_not_lean_at_alpha_0_7) {
  Simulation s(solver(0.03f));
  for (int k = 0; k < 4; ++k)
    s.add_body(box({8, 8, 8}, {-4, -4, 8.2f * static_cast<float>(k)}), material(0.7f));
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  run(s, 150);
  const std::vector<Vec> at = centers(s);
  const double heights[] = {3.8, 11.44, 19.18, 27.05};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(at[k].z(), heights[k], 0.1);
    EXPECT_LT(at[k].head<2>().norm(), 0.15);
  }
}

TEST(stacks, of_two_spacings_rest_as_far_apart_as_the_mean_of_both_and_sleep) {
  struct Spacings {
    float below, above;
  };
  for (const auto [below, above] : {Spacings{1, 1 / 1.5f}, {1, 0.5f}, {2, 1}}) {
    SCOPED_TRACE(testing::Message() << below << ' ' << above);
    SolverConfig config = solver(0.1f);
    config.support_radius = 2.1f * std::max(below, above);
    Simulation s(config);
    const auto add = [&](float spacing, float height) {
      const int n = static_cast<int>(std::lround(6 / spacing));
      Material m = material(0);
      m.region_radius = 2.1f * spacing;
      m.particle_mass = spacing * spacing * spacing;  // both are as dense
      s.add_body(sample(Lattice{
                     .count = {n, n, n}, .spacing = spacing, .corner = {-3, -3, height}, .jitter = 0.02f}),
                 m);
      return static_cast<std::size_t>(n * n * n);
    };
    const std::size_t first_above = add(below, 0);
    add(above, 6.1f);
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    settle(s, 90);
    EXPECT_TRUE(all_sleep(s));
    const double touching = 0.5 * static_cast<double>(below + above);
    EXPECT_GT(nearest(s, first_above), 1.0 * touching);
    EXPECT_LT(nearest(s, first_above), 1.1 * touching);
    EXPECT_LT(centers(s)[1].head<2>().norm(), 0.1);
  }
}

TEST(stacks, rest_where_they_do_whatever_the_lengths_of_steps) {
  for (const float alpha : {0.0f, 0.5f}) {
    Simulation even(solver(0.1f)), odd(solver(0.1f));
    for (Simulation* s : {&even, &odd}) {
      stack(*s, material(alpha), {0, 6.2f});
      s->add_collider({.shape = Plane{}, .friction = 0.5f});
    }
    settle(even, 100);
    const double parts[] = {0.31, 0.07, 0.15, 0.199, 0.011, 0.47, 0.083};
    for (std::size_t k = 0; odd.time() < 100; ++k) odd.advance(parts[k % std::size(parts)]);
    EXPECT_TRUE(all_sleep(even) && all_sleep(odd)) << alpha;
    for (std::size_t k = 0; k < 2; ++k) EXPECT_LT((centers(odd)[k] - centers(even)[k]).norm(), 0.02) << alpha;
  }
}

TEST(stacks, are_carried_along_by_a_floor_that_moves) {
  Simulation s(solver(0.1f));
  stack(s, material(0), {0, 6.2f});
  // With 0.5 a stack twice as high as wide would tip over before it slides.
  const ColliderId floor = s.add_collider({.shape = Box{{-200, -50, -5}, {200, 50, 0}}, .friction = 0.2f});
  settle(s, 60);
  s.set_velocity(floor, {0.3f, 0, 0});
  run(s, 60);
  EXPECT_NEAR(s.motion(BodyId{0}).velocity.x(), 0.3, 0.02);
  EXPECT_NEAR(s.motion(BodyId{1}).velocity.x(), 0.3, 0.04);
  const std::vector<Vec> at = centers(s);
  EXPECT_LT((at[1] - at[0]).head<2>().norm(), 0.5);
  EXPECT_NEAR(at[1].z(), 8.83, 0.1);
}

TEST(stacks, turn_with_a_floor_that_turns) {
  Simulation s(solver(0.1f));
  stack(s, material(0), {0, 6.2f});
  const ColliderId floor = s.add_collider({.shape = Box{{-20, -20, -5}, {20, 20, 0}}, .friction = 0.5f});
  settle(s, 60);
  s.set_twist(floor, {0, 0, 0}, {0, 0, 0.1f});
  run(s, 63);  // once round
  for (const BodyId body : s.bodies()) EXPECT_NEAR(s.motion(body).angular_velocity.z(), 0.1, 0.003);
  for (const Vec& at : centers(s)) EXPECT_LT(at.head<2>().norm(), 0.1);
  EXPECT_NEAR(centers(s)[1].z(), 8.83, 0.05);
}

struct Yielded {
  int updates;
  Vec top;
  bool sleeps;
};
/// Two cubes of 8³ that fall onto a floor and onto each other.
Yielded fall(float alpha, float height, std::optional<float> update_threshold) {
  Simulation s(solver(0.1f));
  for (const float at : {height, 8 + 2 * height})
    s.add_body(box({8, 8, 8}, {-4, -4, at}), {.alpha = alpha, .update_threshold = update_threshold});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  int updates = 0;
  while (s.time() < 120) updates += s.step().updated_references;
  return {updates, centers(s)[1], all_sleep(s)};
}

TEST(stacks, stand_and_sleep_with_the_default_yield_which_a_fall_of_four_spacings_does_not_reach) {
  for (const float alpha : {0.0f, 0.3f}) {
    const Yielded stood = fall(alpha, 4, {});
    EXPECT_EQ(stood.updates, 0) << alpha;
    EXPECT_NEAR(stood.top.z(), 11.72, 0.05) << alpha;
    EXPECT_TRUE(stood.sleeps) << alpha;
  }
}

// Each update takes the shape that the blow has left, so it stands up to 0.7 lower and may lean.
TEST(stacks, stand_and_sleep_where_a_fall_updates_their_reference_shapes) {
  for (const float alpha : {0.0f, 0.3f})
    for (const float height : {2.0f, 4.0f}) {
      const Yielded stood = fall(alpha, height, 1.2f);
      EXPECT_GE(stood.updates, 1) << alpha << ' ' << height;
      EXPECT_GT(stood.top.z(), 11.0) << alpha << ' ' << height;
      EXPECT_LT(stood.top.head<2>().norm(), 1) << alpha << ' ' << height;
      EXPECT_TRUE(stood.sleeps) << alpha << ' ' << height;
    }
}

TEST(stacks, with_a_load_of_ten_times_the_own_density_stand_and_sleep_with_the_default_yield) {
  for (const float alpha : {0.0f, 0.3f}) {
    Simulation s(solver(0.01f));
    s.add_body(box({8, 8, 8}, {-4, -4, 0}), {.alpha = alpha});
    s.add_body(box({6, 6, 6}, {-3, -3, 8.05f}), {.alpha = alpha, .particle_mass = 10.0f});
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    int updates = 0;
    while (s.time() < 120) updates += s.step().updated_references;
    EXPECT_EQ(updates, 0) << alpha;
    EXPECT_TRUE(all_sleep(s)) << alpha;
    EXPECT_NEAR(centers(s)[1].z(), 10.92, 0.05) << alpha;
  }
}

}  // namespace stacks_test
}  // namespace mallow

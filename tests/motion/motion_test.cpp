#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "levels.h"
#include "motion/contact.h"
#include "motion/motion.h"
#include "motion/time_step.h"

namespace mallow {
namespace {

constexpr ContactStep k_step{.time_step = 0.1f, .max_push = 2.0f, .contact_offset = 0.5f};

TEST(contact, leaves_a_velocity_alone_that_does_not_reach_the_surface) {
  const Collider floor{.shape = Plane{}, .friction = 1};
  EXPECT_EQ(resolve_contact(floor, k_step, {0, 0, 1.5f}, {3, 0, -9}), Vec3(3, 0, -9));
}

// Model 5 literally: max(−d/Δt, −e w_n) is −e w_n wherever d >= 0, so that the particle stops where it is.
TEST(contact, stops_a_velocity_that_would_pass_the_surface_within_the_step) {
  const Vec3 v = resolve_contact({.shape = Plane{}}, k_step, {0, 0, 0.7f}, {3, 0, -9});
  EXPECT_FLOAT_EQ(v.z(), 0);
  EXPECT_FLOAT_EQ(v.x(), 3);
}

TEST(contact, bounces_with_the_restitution_relative_to_a_moving_collider) {
  const Collider floor{.shape = Plane{}, .velocity = {1, 0, 2}, .restitution = 0.5f};
  const Vec3 v = resolve_contact(floor, k_step, {0, 0, 0.5f}, {4, 0, -8});
  EXPECT_FLOAT_EQ(v.z(), 2 + 0.5f * 10);
  EXPECT_FLOAT_EQ(v.x(), 4);
}

TEST(contact, pushes_a_deep_overlap_out_no_faster_than_allowed) {
  EXPECT_FLOAT_EQ(resolve_contact({.shape = Plane{}}, k_step, {0, 0, -3}, {0, 0, 0}).z(), 2);
  EXPECT_FLOAT_EQ(resolve_contact({.shape = Plane{}}, k_step, {0, 0, 0.4f}, {0, 0, 0}).z(), 1);
}

TEST(contact, friction_shrinks_the_tangential_velocity_by_the_coulomb_share) {
  const Collider floor{.shape = Plane{}, .friction = 0.25f};
  // Δw_n = 8, so |w_t| = 6 loses 2; and 1.5 is less than that, so it sticks.
  EXPECT_FLOAT_EQ(resolve_contact(floor, k_step, {0, 0, 0.5f}, {6, 0, -8}).x(), 4);
  EXPECT_FLOAT_EQ(resolve_contact(floor, k_step, {0, 0, 0.5f}, {1.5f, 0, -8}).x(), 0);
}

TEST(contact, at_a_sphere_and_in_a_box_acts_along_their_normals) {
  const Collider ball{.shape = Sphere{{0, 0, 0}, 2}};
  const Vec3 v = resolve_contact(ball, k_step, {2.5f, 0, 0}, {-5, 1, 0});
  EXPECT_NEAR(v.x(), 0, 1e-5);
  EXPECT_FLOAT_EQ(v.y(), 1);
  const Collider pool{.shape = Box{{-5, -5, 0}, {5, 5, 10}, true}};
  EXPECT_NEAR(resolve_contact(pool, k_step, {4.5f, 0, 5}, {3, 0, 0}).x(), 0, 1e-5);
}

TEST(time_step, is_the_full_one_for_slow_particles_and_0_999_of_a_radius_for_fast_ones) {
  const TimeStepLimits limits{
      .time_step = 0.15f, .support_radius = 2, .acoustic = false, .sound_speed = 4, .viscous_time = 0.001f};
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 0), static_cast<double>(0.15f));
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 10), static_cast<double>(0.15f));
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 100), 0.999 * 2 / 100);
}

TEST(time_step, acoustic_limit_is_that_of_sound_and_of_viscous_diffusion) {
  TimeStepLimits limits{.time_step = 0.15f,
                        .support_radius = 2,
                        .acoustic = true,
                        .sound_speed = 4,
                        .viscous_time = std::numeric_limits<float>::infinity()};
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 6), 0.4 * 2 / 10);
  limits.viscous_time = 0.4f;
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 6), static_cast<double>(0.4f) / 15);
}

TEST(fastest_particle, sees_numbers_that_are_not_finite_and_passes_over_pinned_ones) {
  // No whole number of lanes.
  constexpr std::size_t n = 603;
  ParticleStore store;
  const std::vector<Vec3> x(n, Vec3(0, 0, 0));
  std::vector<Vec3> v(n, Vec3(1, 0, 0));
  v[300] = v[301] = {0, 5, 0};
  v[310] = {0, 0, 50};
  store.insert(0, x, v);
  store.pin.resize(n);
  store.pin[310] = 1;
  const VectorColumn none(n);
  std::vector<Fastest> partial;
  for (const InstructionLevel level : levels()) {
    const auto find = [&] {
      return fastest_particle(store, 0.1f, none, {0, 0, 0}, nullptr, nullptr, 2, level, partial);
    };
    store.velocity.set(20, v[20]);
    EXPECT_EQ(find().row, 300u);
    EXPECT_FLOAT_EQ(find().squared_velocity, 25);
    for (const std::size_t row : {n - 1, std::size_t{512}, std::size_t{0}}) {
      store.velocity.set(row, {0, 0, 6});
      EXPECT_EQ(find().row, row);
      store.velocity.set(row, v[row]);
    }
    store.velocity.set(20, {std::nanf(""), 0, 0});
    EXPECT_EQ(find().row, 20u);
    EXPECT_TRUE(std::isnan(find().squared_velocity));
  }
}

TEST(fastest_particle, is_not_there_where_all_are_pinned) {
  ParticleStore store;
  const std::vector<Vec3> x(20, Vec3(0, 0, 0));
  store.insert(0, x, x);
  store.pin.resize(20);
  for (std::uint16_t& pin : store.pin) pin = 1;
  const VectorColumn none(20);
  std::vector<Fastest> partial;
  for (const InstructionLevel level : levels())
    EXPECT_EQ(
        fastest_particle(store, 0.1f, none, {0, 0, 1}, nullptr, nullptr, 1, level, partial).squared_velocity,
        -1);
}

TEST(move_colliders, takes_every_part_of_a_union_along) {
  std::vector<Collider> colliders{
      {.shape = Union{{Sphere{{1, 0, 0}, 1}, Box{{0, 0, 0}, {1, 1, 1}}, Plane{}}}, .velocity = {0, 0, 2}}};
  move_colliders(0.5, colliders);
  const auto& parts = std::get<Union>(colliders[0].shape).parts;
  EXPECT_EQ(std::get<Sphere>(parts[0]).center, Vec3(1, 0, 1));
  EXPECT_EQ(std::get<Box>(parts[1]).max, Vec3(1, 1, 2));
  EXPECT_EQ(std::get<Plane>(parts[2]).offset, 1);
}

}  // namespace
}  // namespace mallow

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "levels.h"
#include "motion/contact.h"
#include "motion/motion.h"
#include "motion/time_step.h"

namespace mallow {
namespace motion_test {

constexpr ContactStep k_step{
    .time_step = 0.1f, .max_push = 2.0f, .contact_offset = 0.5f, .gravity = {0, 0, -1}, .least_bounce = 0.2f};

/// Of a particle that nothing but the collider acts on: it comes as it would move on.
Vec3 resolve(const Collider& collider, const Vec3& x, const Vec3& v) {
  return resolve_contact(collider, k_step, x, v, v);
}

TEST(contact, leaves_a_velocity_alone_that_does_not_reach_the_surface) {
  const Collider floor{.shape = Plane{}, .friction = 1};
  EXPECT_EQ(resolve(floor, {0, 0, 1.5f}, {3, 0, -9}), Vec3(3, 0, -9));
}

// Of every shape, from any distance, at any speed: at the end of the step it is where it touches.
TEST(contact, ends_a_step_that_would_pass_the_surface_at_the_surface) {
  const std::vector<std::variant<Plane, Sphere, Box, Union>> shapes = {
      Plane{{0, 0, 2}, -3},
      Sphere{{0, 0, -3.5f}, 2},
      Sphere{{0, 0, 6}, 7.5f, true},
      Box{{-2, -2, -4}, {2, 2, -1.5f}},
      Box{{-2, -2, -1.5f}, {2, 2, 900}, true},
      Union{{Sphere{{0, 0, -3.5f}, 2}, Plane{{0, 1, 0}, -9}}},
  };
  for (const auto& shape : shapes) {
    for (const float height : {-0.9f, 0.0f, 3.0f, 12.0f}) {
      for (const float speed : {1.0f, 30.0f, 200.0f, 1000.0f}) {
        if (height - 0.1f * speed > -1) continue;
        const Vec3 v = resolve({.shape = shape, .friction = 0.5f}, {0, 0, height}, {0, 0, -speed});
        EXPECT_NEAR(height + 0.1f * v.z(), -1, 2e-5f * std::max(1.0f, height))
            << shape.index() << " from " << height << " at " << speed;
      }
    }
  }
}

TEST(contact, lets_a_particle_by_that_passes_an_obstacle) {
  // Nearer to it than its way is long, and towards it, but aside of it.
  for (const Collider& obstacle :
       {Collider{.shape = Sphere{{0, 0, 0}, 1}}, Collider{.shape = Box{{-1, -1, -1}, {1, 1, 1}}}})
    for (const float aside : {1.75f, 2.0f, 4.0f})
      EXPECT_EQ(resolve(obstacle, {aside, 0, 6}, {0, 0, -100}), Vec3(0, 0, -100)) << aside;
}

TEST(contact, keeps_a_particle_in_a_corner_within_all_walls_of_a_box) {
  const Collider room{.shape = Box{{-5, -5, 0}, {5, 5, 10}, true}};
  for (const float speed : {1.0f, 50.0f, 500.0f}) {
    const Vec3 x(4.4f, -4.3f, 0.6f), v = resolve(room, x, Vec3(speed, -speed, -speed));
    const Vec3 expected =
        (x + 0.1f * Vec3(speed, -speed, -speed)).cwiseMin(4.5f).cwiseMax(Vec3(-4.5f, -4.5f, 0.5f));
    EXPECT_LT((x + 0.1f * v - expected).norm(), 1e-5f);
  }
}

TEST(contact, keeps_a_particle_in_a_ball_that_it_would_cross_in_a_step) {
  const Collider ball{.shape = Sphere{{1, 2, 3}, 8, true}};
  for (const Vec3& way : {Vec3(-300, 0, 0), Vec3(90, -500, 20), Vec3(-3, 70, 70)}) {
    const Vec3 x(3, 4, 1), end = x + 0.1f * resolve(ball, x, 10.0f * way);
    EXPECT_LT((end - Vec3(1, 2, 3)).norm(), 7.5f + 1e-3f * way.norm()) << way.transpose();
  }
}

TEST(contact, bounces_relative_to_a_moving_collider_to_e_squared_of_the_height) {
  const Collider floor{.shape = Plane{}, .velocity = {1, 0, 2}, .restitution = 0.5f};
  const Vec3 v = resolve(floor, {0, 0, 0.5f}, {4, 0, -8});
  // Δt g_n/2 = 0.05: what comes with 10 passed the surface with 10.05 half a kick later.
  EXPECT_FLOAT_EQ(v.z(), 2 + std::sqrt(0.25f * 10.05f * 10.05f) - 0.05f);
  EXPECT_FLOAT_EQ(v.x(), 4);
}

TEST(contact, lets_what_comes_slowly_rest) {
  const Collider floor{.shape = Plane{}, .restitution = 1};
  EXPECT_FLOAT_EQ(resolve(floor, {0, 0, 0.5f}, {0, 0, -0.19f}).z(), 0);
  EXPECT_GT(resolve(floor, {0, 0, 0.5f}, {0, 0, -0.21f}).z(), 0.1f);
}

TEST(contact, pushes_a_deep_overlap_out_no_faster_than_allowed) {
  EXPECT_FLOAT_EQ(resolve({.shape = Plane{}}, {0, 0, -3}, {0, 0, 0}).z(), 2);
  EXPECT_FLOAT_EQ(resolve({.shape = Plane{}}, {0, 0, 0.4f}, {0, 0, 0}).z(), 1);
}

TEST(contact, friction_shrinks_the_tangential_velocity_by_the_coulomb_share) {
  const Collider floor{.shape = Plane{}, .friction = 0.25f};
  // Δw_n = 8, so |w_t| = 6 loses 2; and 1.5 is less than that, so it sticks.
  EXPECT_FLOAT_EQ(resolve(floor, {0, 0, 0.5f}, {6, 0, -8}).x(), 4);
  EXPECT_FLOAT_EQ(resolve(floor, {0, 0, 0.5f}, {1.5f, 0, -8}).x(), 0);
}

TEST(contact, friction_takes_no_more_than_what_the_step_has_not_turned_round) {
  const Collider floor{.shape = Plane{}, .friction = 1};
  // It came with 1 and would go back with -4: three quarters are left of what was turned round.
  EXPECT_FLOAT_EQ(resolve_contact(floor, k_step, {0, 0, 0.5f}, {1, 0, 0}, {-4, 0, -8}).x(), -1);
  EXPECT_FLOAT_EQ(resolve_contact(floor, k_step, {0, 0, 0.5f}, {6, 0, 0}, {-4, 0, -8}).x(), -4);
}

TEST(time_step, is_the_full_one_for_slow_particles_and_0_999_of_a_radius_for_fast_ones) {
  const TimeStepLimits::Pressure stiff[] = {{1e6f, 0, 0}};
  const TimeStepLimits limits{
      .time_step = 0.15f, .support_radius = 2, .acoustic = false, .pressures = stiff, .viscous_time = 0.001f};
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 0), static_cast<double>(0.15f));
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 10), static_cast<double>(0.15f));
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 100), 0.999 * 2 / 100);
}

TEST(time_step,
     acoustic_limit_is_that_of_pressure_as_viscosity_calms_it_beside_elasticity_and_of_viscous_diffusion) {
  TimeStepLimits::Pressure pressure[] = {{1, 0, 0}, {400, 0, 0}, {0, 0, 1e6f}};
  TimeStepLimits limits{.time_step = 0.15f,
                        .support_radius = 2,
                        .acoustic = true,
                        .pressures = pressure,
                        .viscous_time = std::numeric_limits<float>::infinity()};
  // α k Δt² = 0.05 σ²
  EXPECT_NEAR(limited_time_step(limits, 6), std::sqrt(0.05 * 4 / 400), 1e-15);
  pressure[1].kinematic_viscosity = 0.01f;
  const double step = limited_time_step(limits, 6);
  EXPECT_NEAR(400 * step * step, 0.05 * 4 + 800 * 0.01 * step, 1e-6);
  pressure[1].kinematic_viscosity = 1;
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 6), std::sqrt(1.4 * 4 / 400));
  pressure[1].stiffness = 150;
  EXPECT_NEAR(limited_time_step(limits, 6), std::sqrt(3.4 / (2 * 100 + 150)), 1e-15);
  limits.viscous_time = 0.4f;
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 6), static_cast<double>(0.4f) / 25);
}

FastestInput fastest_input(const Vec3& gravity, const VectorColumn& sph_acceleration) {
  return {.bodies = {},
          .time_step = 0.1f,
          .gravity = gravity,
          .sph_acceleration = &sph_acceleration,
          .cross_group = nullptr,
          .user = nullptr,
          .blocks = {},
          .partial = {}};
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
  // Two bodies, of which neither is a whole number of blocks.
  FastestInput input = fastest_input({0, 0, 0}, none);
  input.bodies = {{0, 290, 1}, {290, n, 1}};
  for (const InstructionLevel level : levels()) {
    const auto find = [&] { return fastest_particle(store, 2, level, input); };
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
  FastestInput input = fastest_input({0, 0, 1}, none);
  input.bodies = {{0, store.size(), 1}};
  for (const InstructionLevel level : levels())
    EXPECT_EQ(fastest_particle(store, 1, level, input).squared_velocity, -1);
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

}  // namespace motion_test
}  // namespace mallow

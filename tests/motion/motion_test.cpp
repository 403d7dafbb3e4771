#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "levels.h"
#include "motion/time_step.h"

namespace mallow {
namespace motion_test {

TEST(time_step, is_the_full_one_for_slow_particles_and_0_999_of_a_radius_for_fast_ones) {
  const TimeStepLimits::Pressure stiff[] = {{1e6f, 0, 0}};
  const TimeStepLimits limits{.time_step = 0.15f,
                              .support_radius = 2,
                              .farthest = 2,
                              .acoustic = false,
                              .pressures = stiff,
                              .viscous_time = 0.001f};
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 0), static_cast<double>(0.15f));
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 10), static_cast<double>(0.15f));
  EXPECT_DOUBLE_EQ(limited_time_step(limits, 100), 0.999 * 2 / 100);
}

TEST(time_step,
     acoustic_limit_is_that_of_pressure_as_viscosity_calms_it_beside_elasticity_and_of_viscous_diffusion) {
  TimeStepLimits::Pressure pressure[] = {{1, 0, 0}, {400, 0, 0}, {0, 0, 1e6f}};
  TimeStepLimits limits{.time_step = 0.15f,
                        .support_radius = 2,
                        .farthest = 2,
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
    const auto find = [&] { return fastest_particle(store, {2, level}, input); };
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
    EXPECT_EQ(fastest_particle(store, {1, level}, input).squared_velocity, -1);
}

}  // namespace motion_test
}  // namespace mallow

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "mallow/errors.h"
#include "mallow/simulation.h"

namespace mallow {
namespace damping_test {

constexpr float k_step = 0.15f;

Simulation falling_cube(float height, float alpha, std::optional<float> damping) {
  Simulation s({.time_step = k_step, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 1});
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {-4, -4, height}, .jitter = 0.1f}),
             {.alpha = alpha, .update_threshold = 1e9f, .deformation_damping = damping});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  return s;
}
double middle(const Simulation& s) {
  return static_cast<double>(s.positions().eigen().col(2).mean());
}
double fastest(const Simulation& s) {
  float most = 0;
  for (const Vec3& v : s.velocities_by_id()) most = std::max(most, v.norm());
  return static_cast<double>(most);
}
/// How high the middle of a cube rises again after it fell.
double rebound(Simulation s) {
  double last = middle(s), here = last;
  for (; here <= last; here = middle(s)) {
    last = here;
    s.step();
  }
  for (; here >= last; here = middle(s)) {
    last = here;
    s.step();
  }
  return last - 4;
}

/// From when on no particle is faster than 0.001 spacings a step [s].
double quiet_since(Simulation s, double end) {
  double since = 0;
  while (s.time() < end) {
    s.step();
    if (fastest(s) * static_cast<double>(k_step) >= 1e-3) since = s.time();
  }
  return since;
}

struct Fallen {
  float height, alpha;
  double rebound;  ///< share of what it is without damping, at least
  double quiet;    ///< [s], at most
};
/// What holds of bench/PHYSICS.md's table: both, a rebound of 0.95 and quiet after 20 s, cannot.
class FallenCube : public testing::TestWithParam<Fallen> {};

TEST_P(FallenCube, damped_by_default_rebounds_and_then_comes_to_rest) {
  const auto [height, alpha, share, quiet] = GetParam();
  EXPECT_GT(rebound(falling_cube(height, alpha, {})), share * rebound(falling_cube(height, alpha, 0.0f)));
  EXPECT_LT(quiet_since(falling_cube(height, alpha, {}), quiet + 8), quiet);
  EXPECT_GT(quiet_since(falling_cube(height, alpha, 0.0f), quiet + 8), quiet + 7);
}
INSTANTIATE_TEST_SUITE_P(damping, FallenCube,
                         testing::Values(Fallen{1, 0, 0.69, 40}, Fallen{1, 0.3f, 0.69, 30},
                                         Fallen{1, 0.7f, 0.22, 25}, Fallen{3, 0.3f, 0.89, 40},
                                         Fallen{3, 0.7f, 0.78, 32}, Fallen{10, 0, 0.96, 135},
                                         Fallen{10, 0.3f, 0.96, 58}, Fallen{10, 0.7f, 0.94, 48}));

/// A free cube that spins and is stretched.
Simulation stretched(const Material& material, const Vec3& spin) {
  Simulation s({.time_step = k_step, .support_radius = 2.1f, .gravity = {0, 0, 0}, .threads = 1});
  Body body = sample(Lattice{.count = {6, 6, 6}, .corner = {-3, -3, -3}, .jitter = 0});
  for (const Vec3& x : body.positions)
    body.velocities.push_back(spin.cross(x) + Vec3(0.3f + 0.05f * x[0], 0, 0));
  s.add_body(body, material);
  return s;
}
struct Momenta {
  Eigen::Vector3d linear{0, 0, 0}, spin{0, 0, 0};
};
Momenta momenta(const Simulation& s) {
  Momenta sum;
  const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum.linear += v[i].cast<double>();
    sum.spin += x[i].cast<double>().cross(v[i].cast<double>());
  }
  return sum;
}

TEST(damping, by_default_brings_what_has_yielded_to_rest_where_it_is_in_one_part) {
  Simulation s({.time_step = k_step, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 1});
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {-4, -4, 12}, .jitter = 0.1f}),
             {.alpha = 0.3f, .update_threshold = 1.2f});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  int updates = 0;
  while (s.time() < 150) updates += s.step().updated_references;
  EXPECT_GT(updates, 0);
  EXPECT_EQ(s.step().awake_bodies, 0u);
}

TEST(damping, towards_the_rigid_motion_keeps_momentum_and_spin) {
  for (const float rate : {0.1f, 1.0f, 5.0f}) {
    Simulation s = stretched({.deformation_damping = rate}, {0.1f, 0.05f, 0.2f});
    const Momenta before = momenta(s);
    for (int step = 0; step < 300; ++step) s.step();
    const Momenta after = momenta(s);
    EXPECT_LT((after.linear - before.linear).norm(), 1e-5 * before.linear.norm());
    EXPECT_LT((after.spin - before.spin).norm(), 2e-4 * before.spin.norm()) << rate;
  }
}

/// Share of the elastic energy of a swinging cube that is left after some time.
double left_after(const Material& material, double seconds) {
  Simulation s = stretched(material, {0, 0, 0});
  const double moving = 0.5 * 216 * 0.3 * 0.3;  // of the cube as a whole
  const double before = s.energy().conserved - moving;
  while (s.time() < seconds) s.step();
  return (s.energy().conserved - moving) / before;
}

TEST(damping, takes_energy_at_its_rate) {
  // Of energy that is half kinetic in the mean, a rate ζ takes ζ a second.
  const double undamped = left_after({.deformation_damping = 0.0f}, 10);
  EXPECT_NEAR(std::log(undamped / left_after({.deformation_damping = 0.2f}, 10)), 2.0, 0.2);
  EXPECT_GT(undamped, 0.97);
  EXPECT_LT(left_after({.damping_time = 0.05f, .deformation_damping = 0.0f}, 10), 0.8 * undamped);
}

TEST(damping, never_adds_energy) {
  for (const float tau : {0.0f, 0.05f, 0.1f})
    for (const float rate : {0.0f, 0.5f, 20.0f}) {
      if (tau == 0.1f && rate == 20.0f) continue;  // refused, see below
      Simulation s = stretched({.damping_time = tau, .deformation_damping = rate}, {0.2f, 0.1f, 0});
      s.step();
      const double start = s.energy().conserved;
      double most = start;
      for (int step = 0; step < 200; ++step) {
        s.step();
        most = std::max(most, s.energy().conserved);
      }
      EXPECT_LT(most, 1.001 * start) << tau << ' ' << rate;
    }
}

TEST(damping, rate_beyond_what_a_step_carries_is_refused_with_the_most_that_it_does) {
  Simulation s({.time_step = k_step, .support_radius = 2.1f});
  s.add_material({.deformation_damping = 1000.0f});
  s.add_material({.damping_time = 0.1f, .deformation_damping = 7.0f});
  try {
    s.add_material({.damping_time = 0.1f, .deformation_damping = 20.0f});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("material.deformation_damping: 20 is not allowed: at most"),
              std::string::npos)
        << error.what();
  }
}

TEST(damping, time_beyond_what_a_step_carries_is_refused_with_the_most_that_it_does) {
  Simulation s({.time_step = k_step, .support_radius = 2.1f});
  s.add_material({.damping_time = 0.112f});
  try {
    s.add_material({.damping_time = 0.114f});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("material.damping_time: 0.114 is not allowed: at most 0.1125"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace damping_test
}  // namespace mallow

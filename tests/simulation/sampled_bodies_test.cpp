#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mallow/mallow.h"

namespace mallow {
namespace sampled_bodies_test {

constexpr int k_side = 10;

Body cube(float jitter, float height) {
  return sample(Lattice{.count = {k_side, k_side, k_side},
                        .corner = {-0.5f * k_side, -0.5f * k_side, height},
                        .jitter = jitter});
}

/// Share of the particles of a fallen cube that lie on its diagonals, seen from above, to a fiftieth of a
/// spacing.
double on_diagonals(const Body& body, float alpha) {
  Simulation s({.support_radius = 2.9f, .gravity = {0, 0, -0.3f}, .threads = 1});
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.add_body(body, {.alpha = alpha});
  for (int step = 0; step < 150; ++step) s.step();
  std::size_t count = 0;
  for (const Vec3& x : s.positions_by_id()) count += std::abs(std::abs(x.x()) - std::abs(x.y())) < 0.02f;
  return static_cast<double>(count) / static_cast<double>(s.particle_count());
}

TEST(sampled_bodies, spread_without_the_ridges_of_a_perfect_lattice) {
  for (const float alpha : {0.7f, 1.0f}) {
    EXPECT_GT(on_diagonals(cube(0, 3), alpha), 0.1) << "two of ten particles a layer start there";
    EXPECT_LT(on_diagonals(cube(k_default_jitter, 3), alpha), 0.04) << alpha;
  }
}

TEST(sampled_bodies, are_nowhere_denser_than_a_lattice) {
  for (const float radius : {2.1f, 2.9f}) {
    Simulation s({.time_step = 0.15f, .support_radius = radius, .gravity = {0, 0, 0}, .threads = 1});
    s.add_body(cube(k_default_jitter, 0), {.alpha = 1.0f, .pressure_coefficient = 0.0f});
    s.step();
    const float rest = s.info().bodies[0].rest_density;
    for (const float density : s.densities()) EXPECT_LT(density / rest, 1.04f) << "radius " << radius;
  }
}

TEST(sampled_bodies, start_at_rest) {
  for (const float alpha : {0.0f, 0.7f, 1.0f}) {
    const SolverConfig config{.time_step = 0.15f, .support_radius = 2.9f, .gravity = {0, 0, 0}, .threads = 1};
    Simulation s(config);
    s.add_body(cube(k_default_jitter, 0), {.alpha = alpha});
    float fastest = 0;
    for (int step = 0; step < 40; ++step) {
      s.step();
      for (const Vec3& v : s.velocities_by_id()) fastest = std::max(fastest, v.norm());
    }
    EXPECT_LT(fastest * *config.time_step, 0.01f) << alpha << ": in spacings a step";
  }
}

}  // namespace sampled_bodies_test
}  // namespace mallow

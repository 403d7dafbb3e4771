#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "colliders/shapes.h"
#include "mallow/simulation.h"
#include "shapes/random_points.h"

namespace mallow {
namespace drop_test {

constexpr float k_contact_offset = 0.5f;

/// A cube of 6 x 6 x 6 that falls from 1 above z = 0; its middle is at x = y = 0.
Simulation falling_on(const Collider& collider) {
  Simulation s(
      {.time_step = 0.15f, .support_radius = 2.1f, .contact_offset = k_contact_offset, .threads = 1});
  s.add_collider(collider);
  s.add_body(sample(Lattice{.count = {6, 6, 6}, .corner = {-3, -3, 1}, .jitter = 0.05f}),
             Material{.alpha = 0});
  return s;
}

/// The least distance of a particle from a collider.
float nearest_particle(const Simulation& s) {
  float least = INFINITY;
  for (std::size_t i = 0; i < s.particle_count(); ++i)
    least = std::min(least, nearest(s.colliders()[0], s.positions()[i]).distance);
  return least;
}

float fastest_particle(const Simulation& s) {
  float fastest = 0;
  for (std::size_t i = 0; i < s.particle_count(); ++i) fastest = std::max(fastest, s.velocities()[i].norm());
  return fastest;
}

/// Three balls that grow into one another, as a grid of distances: below z = 0, or a hollow that the cube is
/// in.
DistanceField balls(bool inside) {
  const float radius = inside ? 7 : 4, z = inside ? 6 : -4;
  const DistanceFunction distance = [=](const Vec3& x) {
    float least = INFINITY;
    for (const float at : {-4.0f, 0.0f, 4.0f})
      least = std::min(least, (x - Vec3(at, 0.1f * at, z)).norm() - radius);
    return least;
  };
  return distance_field(
      {distance, {{-4 - radius, -1 - radius, z - radius}, {4 + radius, 1 + radius, z + radius}}}, 0.5f,
      inside);
}

std::vector<Vec3> tub_corners() {
  std::vector<Vec3> corners;
  for (const Vec3& half : {Vec3(5, 5, -0.5f), Vec3(9, 9, 20)})
    for (const float x : {-1.0f, 1.0f})
      for (const float y : {-1.0f, 1.0f}) corners.emplace_back(x * half.x(), y * half.y(), half.z());
  return corners;
}

/// What it rests on, by name: its highest part is about at z = 0.
struct Support {
  std::string name;
  Collider::Shape shape;
};
const std::vector<Support> k_supports = {
    {"capsules", Union{{Capsule{{-9, -2, -1}, {9, -2, -1}, 1}, Capsule{{-9, 2, -1}, {9, 2, -1}, 1}}}},
    {"a bowl that is a capsule", Capsule{{-2, 0, 6}, {2, 0, 6}, 7, true}},
    {"a drum", Cylinder{{0, 0, -3}, {0, 0, 0}, 5}},
    {"a tub", Cylinder{{0, 0, -0.5f}, {0, 0, 20}, 6, true}},
    {"a stump", Cone{{0, 0, -3}, {0, 0, 0}, 8, 4}},
    {"a funnel", Cone{{0, 0, -6}, {0, 0, 12}, 1, 12, true}},
    {"a hull", convex_hull(random_points(400, Vec3(-6, -6, -2), Vec3(6, 6, 0)))},
    {"a hollow hull", convex_hull(tub_corners(), true)},
    {"distances from balls", balls(false)},
    {"a hollow of balls", balls(true)},
    {"a pit with a tip", Cone{{0, 0, -9}, {0, 0, 12}, 0, 18, true}},
};

TEST(drop, a_cube_comes_to_rest_on_every_shape_and_does_not_enter_it) {
  for (const Support& support : k_supports) {
    Simulation s = falling_on({.shape = support.shape, .friction = 0.5f});
    float least = INFINITY;
    for (int step = 0; step < 3000; ++step) {
      s.step();
      least = std::min(least, nearest_particle(s));
    }
    EXPECT_GT(least, k_contact_offset - 0.02f) << support.name;
    EXPECT_NEAR(nearest_particle(s), k_contact_offset, 0.02f) << support.name;
    EXPECT_LT(fastest_particle(s), 2e-3f) << support.name;
  }
}

}  // namespace drop_test
}  // namespace mallow

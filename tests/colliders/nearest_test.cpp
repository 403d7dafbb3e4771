#include "mallow/collider.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "shapes/random_points.h"

namespace mallow {
namespace collider_test {

const Plane k_plane{{1.0f, -2.0f, 3.0f}, 2.0f};
const Sphere k_sphere{{0.3f, -0.2f, 0.5f}, 1.1f, false};
const Box k_box{{-1.0f, -0.6f, -0.3f}, {0.8f, 1.2f, 0.9f}, false};
const Capsule k_capsule{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.7f}, 0.7f};
const Cylinder k_cylinder{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.7f}, 0.8f};
const Cone k_cone{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.9f}, 1.2f};
const Cone k_cut_cone{{0.5f, -1, 0}, {0.5f, 1, 0}, 0.4f, 1.1f};
const Union k_union{{k_sphere, k_box, Plane{{0.0f, 0.0f, 1.0f}, -1.5f}}};

using Nearest = std::function<SurfacePoint(const Vec3&)>;

/// Compares normals with central differences, but where the two sides of a crease have different ones.
void expect_normals_are_gradients(const Nearest& query) {
  constexpr float step = 4e-3f;
  int compared = 0;
  for (const Vec3& x : random_points(500, Vec3::Constant(-2.5f), Vec3::Constant(2.5f))) {
    const Vec3 normal = query(x).normal;
    EXPECT_NEAR(normal.norm(), 1.0f, 1e-6f);
    Vec3 gradient;
    bool crease = false;
    for (int axis = 0; axis < 3; ++axis) {
      const SurfacePoint after = query(x + step * Vec3::Unit(axis));
      const SurfacePoint before = query(x - step * Vec3::Unit(axis));
      gradient[axis] = (after.distance - before.distance) / (2.0f * step);
      crease = crease || after.normal.dot(before.normal) < 0.9999f;
    }
    if (crease) continue;
    ++compared;
    EXPECT_LT((gradient - normal).norm(), 4e-3f) << "at " << x.transpose();
  }
  EXPECT_GT(compared, 400);
}

/// What stands at the surface is at distance 0, and a step of `distance` back along the normal leads there.
void expect_normals_lead_to_the_surface(const Nearest& query) {
  for (const Vec3& x : random_points(500, Vec3::Constant(-2.5f), Vec3::Constant(2.5f))) {
    const SurfacePoint point = query(x);
    EXPECT_NEAR(query(x - point.distance * point.normal).distance, 0.0f, 2e-6f) << "at " << x.transpose();
  }
}

std::vector<Vec3> box_surface(const Box& box, int cells) {
  std::vector<Vec3> points;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i <= cells; ++i)
        for (int j = 0; j <= cells; ++j) {
          Vec3 share;
          share[axis] = float(side);
          share[(axis + 1) % 3] = float(i) / float(cells);
          share[(axis + 2) % 3] = float(j) / float(cells);
          points.push_back(box.min + share.cwiseProduct(box.max - box.min));
        }
  return points;
}

TEST(collider, plane_distance_ignores_the_length_of_its_normal) {
  const Plane longer{1e3f * k_plane.normal, 1e3f * k_plane.offset};
  for (const Vec3& x : random_points(100, Vec3::Constant(-3.0f), Vec3::Constant(3.0f))) {
    const SurfacePoint point = nearest(k_plane, x);
    EXPECT_NEAR(point.distance, (k_plane.normal.dot(x) - k_plane.offset) / std::sqrt(14.0f), 1e-6f);
    EXPECT_NEAR(nearest(longer, x).distance, point.distance, 2e-6f);
    EXPECT_LT((nearest(longer, x).normal - point.normal).norm(), 1e-6f);
  }
}

TEST(collider, sphere_distance_is_that_to_its_center_less_the_radius) {
  EXPECT_FLOAT_EQ(nearest(k_sphere, k_sphere.center + Vec3(0.0f, 3.0f, 4.0f)).distance, 3.9f);
  EXPECT_FLOAT_EQ(nearest(k_sphere, k_sphere.center + Vec3(0.1f, 0.0f, 0.0f)).distance, -1.0f);
}

TEST(collider, box_distance_equals_brute_force) {
  constexpr int cells = 60;
  const std::vector<Vec3> surface = box_surface(k_box, cells);
  const float off_the_grid = 0.5f * std::sqrt(2.0f) * 1.8f / float(cells);
  for (const Vec3& x : random_points(300, Vec3::Constant(-2.0f), Vec3::Constant(2.0f))) {
    const float distance = nearest(k_box, x).distance;
    const float brute_force = brute_force_distance(surface, x);
    EXPECT_LE(std::abs(distance), brute_force + 1e-6f);
    EXPECT_GE(std::hypot(distance, off_the_grid), brute_force);
    const bool inside = (x.array() > k_box.min.array()).all() && (x.array() < k_box.max.array()).all();
    EXPECT_EQ(distance < 0.0f, inside);
  }
}

TEST(collider, normals_are_gradients) {
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_plane, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_sphere, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_box, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_capsule, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_cylinder, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_cone, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_cut_cone, x); });
  expect_normals_are_gradients([](const Vec3& x) { return nearest(k_union, x); });
}

TEST(collider, normals_lead_to_the_surface) {
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_plane, x); });
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_sphere, x); });
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_box, x); });
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_capsule, x); });
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_cylinder, x); });
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_cone, x); });
  expect_normals_lead_to_the_surface([](const Vec3& x) { return nearest(k_cut_cone, x); });
}

TEST(collider, inside_flips_distance_and_normal) {
  const auto expect_flipped = [](const auto& solid) {
    auto hollow = solid;
    hollow.inside = true;
    for (const Vec3& x : random_points(200, Vec3::Constant(-2.0f), Vec3::Constant(2.0f))) {
      EXPECT_EQ(nearest(hollow, x).distance, -nearest(solid, x).distance);
      EXPECT_EQ(nearest(hollow, x).normal, -nearest(solid, x).normal);
    }
  };
  expect_flipped(k_sphere);
  expect_flipped(k_box);
  expect_flipped(k_capsule);
  expect_flipped(k_cylinder);
  expect_flipped(k_cone);
  expect_flipped(k_cut_cone);
}

TEST(collider, union_takes_the_nearest_part) {
  for (const Vec3& x : random_points(300, Vec3::Constant(-3.0f), Vec3::Constant(3.0f))) {
    const SurfacePoint point = nearest(k_union, x);
    SurfacePoint expected{1e9f, Vec3::Zero()};
    for (const Primitive& part : k_union.parts) {
      const SurfacePoint one = std::visit([&](const auto& shape) { return nearest(shape, x); }, part);
      if (one.distance < expected.distance) expected = one;
    }
    EXPECT_EQ(point.distance, expected.distance);
    EXPECT_EQ(point.normal, expected.normal);
  }
}

TEST(collider, points_without_a_gradient_have_a_unit_normal) {
  EXPECT_EQ(nearest(k_sphere, k_sphere.center).distance, -1.1f);
  EXPECT_EQ(nearest(k_sphere, k_sphere.center).normal, Vec3::UnitZ());
  const Box cube{Vec3::Constant(-1.0f), Vec3::Constant(1.0f), false};
  EXPECT_EQ(nearest(cube, Vec3::Zero()).distance, -1.0f);
  EXPECT_EQ(nearest(cube, Vec3::Zero()).normal, Vec3::UnitZ());
  EXPECT_EQ(nearest(cube, {1.0f, 0.2f, 0.0f}).distance, 0.0f);
  EXPECT_EQ(nearest(cube, {1.0f, 0.2f, 0.0f}).normal, Vec3::UnitX());
  EXPECT_EQ(nearest(cube, Vec3::Constant(1.0f)).normal.norm(), 1.0f);
}

}  // namespace collider_test
}  // namespace mallow

#include "shapes/primitives.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <vector>

#include "mallow/collider.h"
#include "shapes/random_points.h"

namespace mallow {
namespace primitives_test {

/// Points on the unit sphere, none farther than 1.5 π / rings from its neighbours.
std::vector<Vec3> unit_sphere(int rings) {
  std::vector<Vec3> points;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const float polar = std::numbers::pi_v<float> * float(i) / float(rings);
      const float azimuth = std::numbers::pi_v<float> * float(j) / float(rings);
      points.emplace_back(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                          std::cos(polar));
    }
  return points;
}

TEST(primitives, ellipsoid_distance_equals_brute_force) {
  const Vec3 center{0.2f, -0.1f, 0.3f};
  const Vec3 radii{2.0f, 0.5f, 1.0f};
  constexpr int rings = 200;
  std::vector<Vec3> surface = unit_sphere(rings);
  for (Vec3& point : surface) point = center + radii.cwiseProduct(point);
  constexpr float grid = 2.0f * std::numbers::pi_v<float> / rings;
  for (const Vec3& x : random_points(200, Vec3::Constant(-2.5f), Vec3::Constant(2.5f))) {
    const float distance = ellipsoid_distance(x, center, radii);
    const float brute_force = brute_force_distance(surface, x);
    EXPECT_LE(std::abs(distance), brute_force + 2e-5f);
    EXPECT_GE(std::abs(distance) + grid * std::min(1.0f, grid / brute_force), brute_force);
    EXPECT_EQ(distance < 0.0f, (x - center).cwiseQuotient(radii).norm() < 1.0f);
  }
}

TEST(primitives, ellipsoid_distance_is_exact_on_its_axes_and_at_its_center) {
  const Vec3 radii{2.0f, 0.5f, 1.0f};
  EXPECT_NEAR(ellipsoid_distance(Vec3::Zero(), Vec3::Zero(), radii), -0.5f, 1e-5f);
  EXPECT_NEAR(ellipsoid_distance({5.0f, 0.0f, 0.0f}, Vec3::Zero(), radii), 3.0f, 1e-5f);
  EXPECT_NEAR(ellipsoid_distance({0.0f, 1.5f, 0.0f}, Vec3::Zero(), radii), 1.0f, 1e-5f);
  EXPECT_NEAR(ellipsoid_distance({0.0f, 0.0f, -0.9f}, Vec3::Zero(), {1.0f, 1.0f, 1.0f}), -0.1f, 1e-5f);
}

TEST(primitives, rounded_box_is_a_smaller_box_grown_by_its_rounding) {
  const Vec3 center{0.1f, 0.2f, -0.3f};
  const Vec3 half{1.0f, 0.8f, 0.6f};
  constexpr float rounding = 0.25f;
  for (const Vec3& x : random_points(300, Vec3::Constant(-2.0f), Vec3::Constant(2.0f))) {
    const Vec3 core = half - Vec3::Constant(rounding);
    const SurfacePoint expected = nearest(Box{center - core, center + core, false}, x);
    EXPECT_NEAR(rounded_box_distance(x, center, half, rounding), expected.distance - rounding, 1e-6f);
  }
  EXPECT_NEAR(rounded_box_distance(center + Vec3(1.5f, 0.0f, 0.0f), center, half, rounding), 0.5f, 1e-6f);
}

TEST(primitives, capsule_distance_equals_brute_force) {
  const Vec3 a{-1.0f, 0.2f, 0.0f};
  const Vec3 b{0.7f, 0.9f, -0.4f};
  std::vector<Vec3> segment;
  for (int i = 0; i <= 2000; ++i) segment.push_back(a + float(i) / 2000.0f * (b - a));
  for (const Vec3& x : random_points(300, Vec3::Constant(-2.0f), Vec3::Constant(2.0f))) {
    EXPECT_NEAR(capsule_distance(x, a, b, 0.3f), brute_force_distance(segment, x) - 0.3f, 1e-4f);
  }
}

TEST(primitives, smooth_joints_are_sharp_away_from_the_seam) {
  EXPECT_EQ(smooth_union(1.0f, 3.0f, 0.5f), 1.0f);
  EXPECT_EQ(smooth_intersection(1.0f, 3.0f, 0.5f), 3.0f);
  EXPECT_EQ(smooth_subtraction(-1.0f, 3.0f, 0.5f), -1.0f);
  EXPECT_EQ(smooth_subtraction(-1.0f, -3.0f, 0.5f), 3.0f);
}

TEST(primitives, smooth_joints_add_a_quarter_of_the_blend_at_the_seam) {
  EXPECT_FLOAT_EQ(smooth_union(1.0f, 1.0f, 0.4f), 0.9f);
  EXPECT_FLOAT_EQ(smooth_intersection(1.0f, 1.0f, 0.4f), 1.1f);
  EXPECT_FLOAT_EQ(smooth_subtraction(1.0f, -1.0f, 0.4f), 1.1f);
}

TEST(primitives, slope_is_one_at_most) {
  const auto distance = [](const Vec3& x) {
    const float box = rounded_box_distance(x, {0.5f, 0.0f, 0.0f}, {1.0f, 0.5f, 0.7f}, 0.2f);
    const float bulge = ellipsoid_distance(x, {-0.5f, 0.2f, 0.0f}, {1.2f, 0.4f, 0.8f});
    const float stick = capsule_distance(x, {0.0f, 0.0f, -1.0f}, {0.0f, 0.5f, 1.5f}, 0.3f);
    return smooth_subtraction(smooth_union(box, bulge, 0.5f), stick, 0.3f);
  };
  const std::vector<Vec3> points = random_points(2000, Vec3::Constant(-2.5f), Vec3::Constant(2.5f));
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 near = points[i] + 0.05f * (points[i - 1] - points[i]);
    EXPECT_LE(std::abs(distance(near) - distance(points[i])), 1.001f * (near - points[i]).norm() + 1e-5f);
  }
}

}  // namespace primitives_test
}  // namespace mallow

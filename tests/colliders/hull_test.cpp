#include "colliders/hull.h"

#include <gtest/gtest.h>

#include "colliders/shapes.h"
#include "meshes.h"
#include "shapes/random_points.h"

namespace mallow {
namespace hull_test {

std::vector<Vec3> corners_of(const Box& box) {
  return box_mesh(box.min, box.max).vertices;
}

const Box k_box{{-1, -0.6f, -0.3f}, {0.8f, 1.2f, 0.9f}};

TEST(hull, of_the_corners_of_a_box_and_points_in_it_is_the_box) {
  std::vector<Vec3> points = random_points(2000, k_box.min, k_box.max);
  for (const Vec3& corner : corners_of(k_box)) points.push_back(corner);
  for (Vec3& x : random_points(200, k_box.min, k_box.max)) {
    x.z() = k_box.max.z();
    points.push_back(x);
  }
  const ConvexHull hull = convex_hull(points);
  EXPECT_EQ(hull.data->planes.size(), 6u);
  EXPECT_EQ(hull.data->edges.size(), 12u);
  for (const Vec3& x : random_points(5000, Vec3::Constant(-2.5f), Vec3::Constant(2.5f))) {
    const SurfacePoint expected = nearest(k_box, x), point = nearest(hull, x);
    EXPECT_NEAR(point.distance, expected.distance, 2e-6f);
    EXPECT_LT((point.normal - expected.normal).norm(), 5e-4f) << x.transpose();
  }
}

TEST(hull, holds_all_of_its_points_and_its_corners_are_some_of_them) {
  for (const std::size_t count : {4u, 5u, 30u, 1000u}) {
    const std::vector<Vec3> points = random_points(count, Vec3(-3, 0, 100), Vec3(5, 0.5f, 120));
    const ConvexHull hull = convex_hull(points);
    for (const Vec3& x : points) EXPECT_LT(nearest(hull, x).distance, 3e-5f);
    for (const Vec3& corner : hull.data->corners)
      EXPECT_NE(std::find(points.begin(), points.end(), corner), points.end());
    // Euler: faces and corners are two more than edges, once faces of one plane are one.
    EXPECT_EQ(hull.data->planes.size() + hull.data->corners.size(), hull.data->edges.size() + 2);
  }
}

TEST(hull, of_a_lattice_of_points_has_no_more_faces_than_it_needs) {
  std::vector<Vec3> points;
  for (int i = 0; i < 1000; ++i)
    points.emplace_back(0.1f * static_cast<float>(i % 10), 0.1f * static_cast<float>(i / 10 % 10),
                        0.1f * static_cast<float>(i / 100));
  const ConvexHull hull = convex_hull(points);
  EXPECT_EQ(hull.data->planes.size(), 6u);
  EXPECT_NEAR(nearest(hull, {2, 2, 2}).distance, std::sqrt(3.0f) * 1.1f, 2e-6f);
}

TEST(hull, of_points_on_a_ball_is_near_the_ball) {
  const ConvexHull hull = convex_hull(sphere_mesh({1, 2, 3}, 2, 20).vertices);
  for (const Vec3& x : random_points(2000, Vec3(-3, -2, -1), Vec3(5, 6, 7)))
    EXPECT_NEAR(nearest(hull, x).distance, nearest(Sphere{{1, 2, 3}, 2}, x).distance, 0.03f);
}

TEST(hull, of_what_encloses_nothing_or_has_too_many_corners_is_refused) {
  const auto problem = [](const std::vector<Vec3>& points) {
    return problem_of([&] { convex_hull(points); });
  };
  EXPECT_NE(problem({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).find("at least 4"), std::string::npos);
  EXPECT_NE(problem(std::vector<Vec3>(9, Vec3(1, 2, 3))).find("at one place"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).find("in one line"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}).find("in one plane"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 1}, {1, 0, 1}, {0, std::nanf(""), 1}, {1, 1, 2}}).find("hull.points[2]"),
            std::string::npos);
  EXPECT_NE(problem(sphere_mesh({0, 0, 0}, 1, 30).vertices).find("at most 1024"), std::string::npos);
}

}  // namespace hull_test
}  // namespace mallow

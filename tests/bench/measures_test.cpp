#include "figures/measures.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/disjoint_sets.h"
#include "figures/connected_parts.h"
#include "mallow/body.h"

namespace mallow::bench {
namespace measures_test {

std::vector<Vec3> box(std::array<int, 3> count, const Vec3& corner = {0, 0, 0}, float jitter = 0) {
  return sample(Lattice{.count = count, .spacing = 1, .corner = corner, .jitter = jitter}).positions;
}

std::vector<Vec3> moved(std::vector<Vec3> points) {
  const Eigen::AngleAxisf turn(0.7f, Vec3(1, 2, -1).normalized());
  for (Vec3& x : points) x = turn * x + Vec3(3, -4, 5);
  return points;
}

TEST(connected_parts, are_told_by_gaps_and_come_largest_first) {
  std::vector<Vec3> points = box({4, 4, 4});
  for (const Vec3& x : box({3, 3, 6}, {10, 0, 0})) points.push_back(x);  // far from the first
  for (const Vec3& x : box({1, 1, 4}, {5, 0, 0})) points.push_back(x);   // a gap of 2 to the first
  points.push_back({0.5f, 0.5f, 50});
  EXPECT_EQ(connected_parts(points, 1.6f, 1), (std::vector<std::size_t>{64, 54, 4, 1}));
  EXPECT_EQ(connected_parts(points, 2.1f, 1), (std::vector<std::size_t>{68, 54, 1}));
  EXPECT_EQ(connected_parts(points, 2.1f, 2), (std::vector<std::size_t>{68, 54, 1}));
  EXPECT_EQ(count_parts(connected_parts(points, 1.6f, 1)), 3u) << "the single point is a crumb";
  EXPECT_DOUBLE_EQ(largest_share(connected_parts(points, 1.6f, 1)), 64.0 / 123);
}

TEST(connected_parts, of_a_sampled_body_are_one_at_the_largest_jitter_in_use) {
  EXPECT_EQ(connected_parts(box({12, 12, 12}, {0, 0, 0}, 0.2f), static_cast<float>(k_touching), 1),
            std::vector<std::size_t>{1728});
}

TEST(measures, of_a_cube_do_not_change_when_it_is_tipped) {
  const std::vector<Vec3> cube = box({10, 10, 10});
  // Of points in the cells' middles: side √(1 − 1/n²).
  EXPECT_NEAR(column_height(cube), 10 * std::sqrt(0.99), 1e-4);
  EXPECT_NEAR(column_height(moved(cube)), column_height(cube), 1e-4);
  EXPECT_NEAR(horizontal_spread(moved(cube)), horizontal_spread(cube), 1e-4);
  EXPECT_NEAR(horizontal_spread(cube), 10 * std::sqrt(0.99 / 6), 1e-4);
}

TEST(measures, a_rigid_motion_is_no_distance_and_a_stretch_is_one) {
  const std::vector<Vec3> cube = box({6, 6, 6});
  EXPECT_NEAR(distance_to_rigid_motion(cube, moved(cube)), 0, 1e-5);
  std::vector<Vec3> stretched = cube;
  for (Vec3& x : stretched) x.z() *= 1.5f;
  double squares = 0;
  for (const Vec3& x : cube) squares += std::pow(0.5 * (static_cast<double>(x.z()) - 3), 2);
  EXPECT_NEAR(distance_to_rigid_motion(cube, stretched), std::sqrt(squares / 216), 1e-5);
  std::vector<Vec3> mirrored = cube;
  mirrored[0] *= -1;  // one particle elsewhere
  EXPECT_GT(distance_to_rigid_motion(cube, mirrored), 0.01);
}

TEST(measures, quantiles_and_tops_of_heights) {
  std::vector<Vec3> pool = box({8, 8, 3});
  EXPECT_DOUBLE_EQ(height_quantile(pool, 0), 0.5);
  EXPECT_DOUBLE_EQ(height_quantile(pool, 1), 2.5);
  EXPECT_DOUBLE_EQ(unevenness(pool, 2), 0);
  for (const Vec3& x : box({4, 8, 2}, {0, 0, 3})) pool.push_back(x);  // half of it two higher
  EXPECT_DOUBLE_EQ(unevenness(pool, 2), 1);
  pool.push_back({0.5f, 0.5f, 100});
  EXPECT_DOUBLE_EQ(height_quantile(pool, 0.99), 4.5) << "one in 257 above";
}

TEST(measures, of_curves) {
  const std::vector<double> curve = {4, -1, 2, 3};
  EXPECT_EQ(lowest(curve), -1);
  EXPECT_EQ(highest(curve), 4);
  EXPECT_EQ(highest(last_of(curve, 0.5)), 3);
  EXPECT_EQ(mean_of_last(curve, 0.5), 2.5);
  EXPECT_EQ(mean_of_last(curve, 1), 2);
  EXPECT_EQ(mean_of_last(curve, 0.01), 3) << "never of none";
}

}  // namespace measures_test
}  // namespace mallow::bench

#include "surface/nearest_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

namespace mallow::test {
namespace nearest_points_test {

std::vector<Vec3> cloud(std::size_t count, float size, const Vec3& middle, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-size, size);
  std::vector<Vec3> points(count);
  for (Vec3& point : points) point = middle + Vec3{place(random), place(random), 0.1f * place(random)};
  return points;
}

TEST(nearest_points, are_those_of_brute_force_however_far) {
  const std::vector<Vec3> others = cloud(700, 2, {0, 0, 0}, 1);
  std::vector<Vec3> points = cloud(500, 3, {0.3f, 0, 0}, 2);
  for (const Vec3& far : cloud(20, 1, {400, -70, 5}, 3)) points.push_back(far);
  points.push_back(others[41]);
  const std::vector<NearestPoint> found = find_nearest(points, others, 0.1f, 2);
  ASSERT_EQ(found.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    float least = std::numeric_limits<float>::infinity();
    for (const Vec3& other : others) least = std::min(least, (other - points[i]).squaredNorm());
    EXPECT_EQ(found[i].distance, std::sqrt(least)) << i;
    EXPECT_EQ((others[found[i].index] - points[i]).norm(), found[i].distance) << i;
  }
  EXPECT_EQ(found.back().index, 41u);
  EXPECT_EQ(find_nearest(points, others, 5, 1)[0].distance, found[0].distance) << "whatever the spacing";
}

TEST(nearest_points, several_are_those_of_brute_force_by_distance_and_then_index) {
  std::vector<Vec3> others = cloud(300, 2, {0, 0, 0}, 4);
  others.insert(others.begin() + 100, others.begin(), others.begin() + 50);  // some lie on each other
  const std::vector<Vec3> points = cloud(200, 3, {0.3f, 0, 0}, 5);
  constexpr std::size_t k_count = 8;
  const std::vector<NearestPoint> found = find_several_nearest(points, others, k_count, 0.1f, 2);
  ASSERT_EQ(found.size(), k_count * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<std::pair<float, std::uint32_t>> all;
    for (std::uint32_t j = 0; j < others.size(); ++j)
      all.emplace_back((others[j] - points[i]).squaredNorm(), j);
    std::ranges::sort(all);
    for (std::size_t k = 0; k < k_count; ++k) {
      EXPECT_EQ(found[i * k_count + k].index, all[k].second) << i << " " << k;
      EXPECT_EQ(found[i * k_count + k].distance, std::sqrt(all[k].first));
    }
  }
  EXPECT_EQ(find_several_nearest(points, std::span(others).first(3), k_count, 0.1f, 1).size(),
            3 * points.size())
      << "no more than there are";
}

TEST(nearest_points, of_one_point_is_that_one) {
  const std::vector<Vec3> one = {{1, 2, 3}}, here = {{1, 2, 3}, {4, 6, 3}};
  const std::vector<NearestPoint> found = find_nearest(here, one, 1, 1);
  EXPECT_EQ(found[0].distance, 0);
  EXPECT_EQ(found[1].distance, 5);
}

}  // namespace nearest_points_test
}  // namespace mallow::test

#include "tradeoff/surface_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "mallow/surface.h"
#include "meshes.h"

namespace mallow::surface_error_test {

/// A sphere with the normals of the sphere at its vertices.
Mesh sphere(float radius, int stacks) {
  Mesh mesh = sphere_mesh({0, 0, 0}, radius, stacks);
  for (const Vec3& vertex : mesh.vertices) mesh.normals.push_back(vertex.normalized());
  return mesh;
}

TEST(tradeoff_surface, error_is_the_distance_between_two_spheres_in_spacings) {
  EXPECT_NEAR(tradeoff::surface_error(sphere(1.0f, 20), sphere(1.02f, 60), 0.1f, 1), 0.2, 0.002);
  EXPECT_EQ(tradeoff::surface_error(sphere(1.0f, 20), sphere(1.0f, 20), 0.1f, 1), 0);
}

TEST(tradeoff_surface, where_vertices_lie_on_one_surface_does_not_count) {
  const double between_vertices = std::numbers::pi / 20 / 2 / 0.3;
  EXPECT_LT(tradeoff::surface_error(sphere(1.0f, 20), sphere(1.0f, 33), 0.3f, 1), 0.01 * between_vertices);
}

TEST(tradeoff_surface, what_only_one_mesh_has_counts_with_its_distance) {
  Mesh both = sphere(1.0f, 20), far = sphere(1.0f, 20);
  for (Vec3& vertex : far.vertices) vertex.x() += 10;
  const auto normals = far.normals;
  append(both, far);
  both.normals.insert(both.normals.end(), normals.begin(), normals.end());
  const double error = tradeoff::surface_error(sphere(1.0f, 20), both, 0.1f, 1);
  EXPECT_GT(error, 80 / std::sqrt(3));
  EXPECT_TRUE(std::isinf(tradeoff::surface_error({}, both, 0.1f, 1)));
  EXPECT_EQ(tradeoff::surface_error({}, {}, 0.1f, 1), 0);
}

/// Points of a cubic lattice in a ball.
std::vector<Vec3> ball(float spacing) {
  std::vector<Vec3> points;
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j)
      for (int k = -6; k <= 6; ++k)
        if (const Vec3 x = Vec3(Eigen::Vector3i(i, j, k).cast<float>()); x.norm() < 6)
          points.emplace_back(spacing * x);
  return points;
}

TEST(tradeoff_surface, error_falls_with_the_voxels) {
  const auto points = ball(0.01f);
  const auto drawn = [&](float voxels) { return surface(points, 0.01f, {.voxels_per_spacing = voxels}, 1); };
  const Mesh fine = drawn(6);
  const double coarse = tradeoff::surface_error(drawn(1.5f), fine, 0.01f, 1);
  EXPECT_LT(2 * tradeoff::surface_error(drawn(3), fine, 0.01f, 1), coarse);
  EXPECT_LT(coarse, 0.2);
}

}  // namespace mallow::surface_error_test

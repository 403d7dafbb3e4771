#include <gtest/gtest.h>

#include <cmath>

#include "mallow/level_set.h"
#include "meshes.h"
#include "shapes/random_points.h"

namespace mallow {
namespace mesh_collider_test {

TEST(mesh_collider, of_a_box_is_the_box_within_a_twentieth_of_a_voxel) {
  const Box box{{-1, -2, 0.3f}, {1.1f, 2, 1.7f}};
  const DistanceField field = mesh_collider(box_mesh(box.min, box.max), 40);
  const float voxel = field.grid->voxel_size;
  EXPECT_FLOAT_EQ(voxel, 0.1f);
  for (const Vec3& x : random_points(5000, Vec3(-1.5f, -2.5f, 0), Vec3(1.5f, 2.5f, 2.2f))) {
    const float expected = nearest(box, x).distance;
    const SurfacePoint point = nearest(field, x);
    EXPECT_NEAR(point.normal.norm(), 1, 1e-6f);
    // Edges are cut within a voxel of them.
    if (std::abs(expected) < 2.5f * voxel) {
      EXPECT_NEAR(point.distance, expected, 0.6f * voxel) << x.transpose();
    }
    if (expected > 0) {
      EXPECT_LT(point.distance, expected + 0.3f * voxel) << x.transpose();
    }
  }
  EXPECT_LT((bounds(field).max - box.max).norm(), 0.05f * voxel);
}

TEST(mesh_collider, of_a_ball_is_near_the_ball_everywhere_and_flips_inside) {
  const Mesh mesh = sphere_mesh({1, 2, 3}, 2, 40);
  const DistanceField field = mesh_collider(mesh, 64), hollow = mesh_collider(mesh, 64, true);
  for (const Vec3& x : random_points(5000, Vec3(-3, -2, -1), Vec3(5, 6, 7))) {
    const SurfacePoint expected = nearest(Sphere{{1, 2, 3}, 2}, x), point = nearest(field, x);
    // From a voxel on, which is 1/16, points of cells may lie beyond the band, where sweeping is a little
    // off.
    if (std::abs(expected.distance) < 0.06f) {
      EXPECT_NEAR(point.distance, expected.distance, 0.01f);
      EXPECT_LT((point.normal - expected.normal).norm(), 0.06f);
    }
    if (expected.distance > 0) {
      EXPECT_LT(point.distance, expected.distance + 0.02f);
      // Beside the grid, where it is a bound: 1/√2 of what the sweeps have.
      EXPECT_GT(point.distance, 0.6f * expected.distance - 0.01f);
    }
    EXPECT_EQ(nearest(hollow, x).distance, -point.distance);
  }
}

TEST(mesh_collider, of_equal_meshes_is_made_once) {
  const Mesh mesh = sphere_mesh({0, 0, 0}, 1, 10);
  const DistanceField one = mesh_collider(mesh, 16);
  EXPECT_EQ(mesh_collider(mesh, 16, true, 2).grid, one.grid);
  EXPECT_NE(mesh_collider(mesh, 17).grid, one.grid);
  EXPECT_NE(mesh_collider(sphere_mesh({0, 0, 0}, 1, 11), 16).grid, one.grid);
}

TEST(mesh_collider, has_the_same_bits_for_any_thread_count) {
  const Mesh mesh = sphere_mesh({0, 0, 0}, 1, 10);
  const std::vector<float> one = mesh_collider(mesh, 24, false, 1).grid->distances;
  EXPECT_EQ(mesh_collider(mesh, 24, false, 3).grid->distances, one);
}

TEST(mesh_collider, of_an_open_mesh_is_refused) {
  Mesh open = box_mesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  EXPECT_THROW(mesh_collider(open), ConfigError);
  EXPECT_THROW(mesh_collider(box_mesh({0, 0, 0}, {1, 1, 1}), 4), ConfigError);
}

}  // namespace mesh_collider_test
}  // namespace mallow

#include <limits>

#include "level_set/meshes.h"
#include "mallow/level_set.h"

namespace mallow {
namespace {

constexpr int k_voxels = 64;

TEST(mesh_shape, sphere_matches_analytic_distance) {
  const Vec3 center(3, -2, 1);
  const ImplicitShape shape = mesh_shape(sphere_mesh(center, 2, 200), k_voxels);
  const float voxel = 4.0f / k_voxels;
  for (float from_surface = -2; from_surface <= 2; from_surface += 0.25f) {
    for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 2, 3), Vec3(-3, 1, -2)}) {
      const Vec3 x = center + (2 + from_surface * voxel) * direction.normalized();
      EXPECT_NEAR(shape.distance(x), from_surface * voxel, 0.05f * voxel)
          << from_surface << " voxels from the surface";
    }
  }
}

TEST(mesh_shape, has_the_right_sign_far_from_the_surface) {
  const ImplicitShape shape = mesh_shape(sphere_mesh({0, 0, 0}, 1, 50), k_voxels);
  EXPECT_LT(shape.distance({0, 0, 0}), -2.0f * 2.0f / k_voxels);
  EXPECT_LT(shape.distance({0.5f, 0.2f, 0}), -2.0f * 2.0f / k_voxels);
  EXPECT_GT(shape.distance({1.5f, 0, 0}), 2.0f * 2.0f / k_voxels);
  EXPECT_GT(shape.distance({1e6f, -1e6f, 1e6f}), 2.0f * 2.0f / k_voxels);
}

TEST(mesh_shape, keeps_the_volume_and_bounds_of_the_mesh) {
  const Mesh mesh = sphere_mesh({10, 20, 30}, 3, 40);
  const ImplicitShape shape = mesh_shape(mesh, k_voxels);
  EXPECT_EQ(shape.bounds.min, bounds(mesh).min);
  EXPECT_EQ(shape.bounds.max, bounds(mesh).max);
  const float step = 6.0f / 80;
  std::size_t inside = 0;
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j)
      for (int k = 0; k < 80; ++k)
        inside += shape.distance(shape.bounds.min +
                                 step * (Vec3::Constant(0.5f) + Eigen::Vector3i(i, j, k).cast<float>())) < 0;
  EXPECT_NEAR(static_cast<double>(inside) * std::pow(step, 3), signed_volume(mesh),
              0.005 * signed_volume(mesh));
}

TEST(mesh_shape, is_as_precise_far_from_the_origin) {
  const Vec3 center(1e5f, -1e5f, 5e4f);
  const ImplicitShape shape = mesh_shape(sphere_mesh(center, 64, 100), k_voxels);
  for (const float r : {62.0f, 63.0f, 64.0f, 65.0f, 66.0f})
    EXPECT_NEAR(shape.distance(center + Vec3(0, r, 0)), r - 64, 0.1f);
}

TEST(mesh_shape, same_bits_for_any_thread_count) {
  const Mesh mesh = sphere_mesh({0, 0, 0}, 1, 60);
  const ImplicitShape one = mesh_shape(mesh, k_voxels, 1);
  for (const int threads : {2, 3}) {
    const ImplicitShape other = mesh_shape(mesh, k_voxels, threads);
    for (int i = 0; i < 4000; ++i) {
      const float t = static_cast<float>(i);
      const Vec3 x(std::sin(t), std::sin(1.7f * t), std::sin(2.3f * t));
      ASSERT_EQ(one.distance(x), other.distance(x)) << threads << " threads, point " << i;
    }
  }
}

TEST(mesh_shape, refuses_what_encloses_nothing) {
  expect_words(config_error([] { mesh_shape({}); }), {"mesh", "does not enclose", "no triangles"});
  Mesh open = sphere_mesh({0, 0, 0}, 1, 10);
  open.triangles.pop_back();
  expect_words(config_error([&] { mesh_shape(open); }), {"mesh", "does not enclose", "3 open edges"});
  Mesh point;
  point.vertices.assign(4, Vec3(1, 2, 3));
  point.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  expect_words(config_error([&] { mesh_shape(point); }), {"mesh", "all vertices are at one point"});
}

TEST(mesh_shape, refuses_vertices_that_are_not_finite_and_voxels_out_of_range) {
  Mesh mesh = sphere_mesh({0, 0, 0}, 1, 10);
  expect_words(config_error([&] { mesh_shape(mesh, 4); }), {"voxels: 4", "8 to 2048"});
  expect_words(config_error([&] { mesh_shape(mesh, 64, -1); }), {"threads: -1"});
  mesh.vertices[7].y() = std::numeric_limits<float>::quiet_NaN();
  expect_words(config_error([&] { mesh_shape(mesh); }), {"mesh.vertices[7]", "nan", "finite"});
}

}  // namespace
}  // namespace mallow

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "mallow/body.h"
#include "mallow/surface.h"
#include "meshes.h"

namespace mallow {
namespace surface_test {

constexpr SurfaceConfig k_coarse{.voxels = 64};

std::vector<Vec3> cube_points(int n, float h, const Vec3& corner = {0, 0, 0}) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        points.push_back(corner + h * (Vec3::Constant(0.5f) + Eigen::Vector3i(i, j, k).cast<float>()));
  return points;
}

std::vector<Vec3> ball_points(float radius, float jitter = 0) {
  std::mt19937 random(1);
  std::vector<Vec3> points;
  const int n = static_cast<int>(radius) + 1;
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      for (int k = -n; k <= n; ++k) {
        Vec3 x = Eigen::Vector3i(i, j, k).cast<float>();
        if (x.norm() > radius) continue;
        for (float& c : x) c += jitter * (2 * static_cast<float>(random()) / 4294967296.0f - 1);
        points.push_back(x);
      }
    }
  }
  return points;
}

void expect_sound(const Mesh& mesh, std::size_t components) {
  EXPECT_EQ(why_not_closed(mesh), "");
  EXPECT_EQ(component_count(mesh), components);
  EXPECT_GT(signed_volume(mesh), 0);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (const Vec3& normal : mesh.normals) ASSERT_NEAR(normal.norm(), 1, 1e-5f);
}

/// Shells one spacing apart, one particle per unit of area: golden spirals.
std::vector<Vec3> shell_points(int radius) {
  std::vector<Vec3> points;
  for (int r = radius; r > 0; --r) {
    const int n = static_cast<int>(4 * std::numbers::pi * r * r);
    for (int i = 0; i < n; ++i) {
      const double z = 1 - (2 * i + 1.0) / n, azimuth = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
      const double rho = std::sqrt(1 - z * z);
      points.push_back(
          (r * Eigen::Vector3d(rho * std::cos(azimuth), rho * std::sin(azimuth), z)).cast<float>());
    }
  }
  return points;
}

struct Radii {
  float lowest = 1e9f, highest = 0, least_cosine = 1;
};

/// Of a surface around the origin; least_cosine: of the angle between a normal and the direction from the
/// origin.
Radii radii(const Mesh& mesh) {
  Radii r;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    r.lowest = std::min(r.lowest, mesh.vertices[v].norm());
    r.highest = std::max(r.highest, mesh.vertices[v].norm());
    r.least_cosine = std::min(r.least_cosine, mesh.normals[v].dot(mesh.vertices[v].normalized()));
  }
  return r;
}

TEST(surface, of_a_ball_lies_at_the_particle_radius_and_is_smooth) {
  const Mesh mesh = surface(shell_points(10), 1, {});
  expect_sound(mesh, 1);
  const Radii r = radii(mesh);
  EXPECT_GT(r.lowest, 10.55f - 0.15f);
  EXPECT_LT(r.highest, 10.55f + 0.15f);
  EXPECT_GT(r.least_cosine, 0.95f);
}

/// The lattice's steps put the outermost particles between about 9.2 and 10 from the centre.
TEST(surface, of_a_lattice_ball_follows_its_particles) {
  const Mesh mesh = surface(ball_points(10), 1, {});
  expect_sound(mesh, 1);
  const Radii r = radii(mesh);
  EXPECT_GT(r.lowest, 9.2f + 0.45f);
  EXPECT_LT(r.highest, 10.6f);
  EXPECT_GT(r.least_cosine, 0.75f);
}

TEST(surface, of_a_cube_keeps_the_volume_of_its_particles) {
  const float h = 22.0f / 15;
  const Mesh mesh = surface(cube_points(15, h), h, {});
  expect_sound(mesh, 1);
  EXPECT_NEAR(signed_volume(mesh), 22.0 * 22 * 22, 0.02 * 22 * 22 * 22);
}

TEST(surface, of_a_cube_has_flat_faces_at_the_particle_radius) {
  for (const float kernel_radius : {1.5f, 2.0f, 3.0f, 4.0f}) {
    const Mesh mesh = surface(cube_points(12, 1), 1, {.kernel_radius = kernel_radius});
    int on_top = 0;
    for (const Vec3& x : mesh.vertices) {
      if (std::abs(x.x() - 6) > 2 || std::abs(x.y() - 6) > 2 || x.z() < 6) continue;
      ASSERT_NEAR(x.z(), 11.5f + 0.55f, 0.06f) << "kernel radius " << kernel_radius;
      ++on_top;
    }
    EXPECT_GT(on_top, 100);
  }
}

TEST(surface, has_no_hidden_shells_in_loose_and_in_shaken_bodies) {
  expect_sound(surface(cube_points(8, 1.3f), 1, k_coarse), 1);
  expect_sound(surface(ball_points(8, 0.3f), 1, k_coarse), 1);
  expect_sound(surface(cube_points(12, 0.7f), 1, k_coarse), 1);
}

TEST(surface, keeps_two_bodies_apart_without_crumbs_between_them) {
  for (const float gap : {2.3f, 2.6f, 3.0f, 3.5f}) {
    std::vector<Vec3> points = cube_points(6, 1);
    for (const Vec3& x : cube_points(6, 1, {0, 0, 5 + gap})) points.push_back(x);
    SCOPED_TRACE(gap);
    expect_sound(surface(points, 1, {.voxel_size = 0.15f}), 2);
  }
}

TEST(surface, of_one_particle_is_a_small_sphere) {
  const Vec3 center(5, 6, 7);
  const Mesh mesh = surface(std::vector<Vec3>{center}, 1, k_coarse);
  expect_sound(mesh, 1);
  for (const Vec3& x : mesh.vertices) ASSERT_NEAR((x - center).norm(), 0.56f, 0.03f);
}

TEST(surface, of_two_particles_is_one_piece_when_near_and_two_when_far) {
  expect_sound(surface(std::vector<Vec3>{{0, 0, 0}, {1.3f, 0, 0}}, 1, k_coarse), 1);
  for (const float distance : {2.2f, 2.4f, 2.7f, 3.0f, 50.0f}) {
    SCOPED_TRACE(distance);
    expect_sound(surface(std::vector<Vec3>{{0, 0, 0}, {distance, 0, 0}}, 1, {.voxel_size = 0.05f}), 2);
  }
}

TEST(surface, of_a_sheet_has_two_sides) {
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) points.emplace_back(static_cast<float>(i), static_cast<float>(j), 0.0f);
  const Mesh mesh = surface(points, 1, k_coarse);
  expect_sound(mesh, 1);
  EXPECT_NEAR(signed_volume(mesh), 1.1 * 12 * 12, 0.05 * 1.1 * 12 * 12);
}

/// Voxels as wide as those that sums are still interpolated to may be: 0.11 kernel radii.
TEST(surface, is_one_piece_where_kernels_reach_far_and_where_a_body_is_pressed) {
  for (const float kernel_radius : {2.0f, 2.5f, 3.0f, 4.0f}) {
    for (const float pressed : {1.0f, 0.8f}) {
      for (const float share : {0.09f, 0.0995f, 0.1095f}) {
        SCOPED_TRACE(testing::Message() << kernel_radius << ", " << pressed << ", " << share);
        std::vector<Vec3> points =
            sample(Lattice{.count = {9, 9, 9}, .spacing = 1, .jitter = 0.3f}).positions;
        for (Vec3& x : points) x = pressed * (Eigen::AngleAxisf(0.5f, Vec3(1, 2, 3).normalized()) * x);
        expect_sound(
            surface(points, 1, {.voxel_size = share * kernel_radius, .kernel_radius = kernel_radius}), 1);
      }
    }
  }
}

TEST(surface, of_no_particles_is_empty) {
  const Mesh mesh = surface({}, 1, {});
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(surface, stays_closed_with_voxels_coarser_than_the_spacing) {
  std::vector<Vec3> points = cube_points(40, 1);
  points.emplace_back(60.0f, 60.0f, 60.0f);
  const Mesh mesh = surface(points, 1, {.voxels = 16});
  EXPECT_EQ(why_not_closed(mesh), "");
  EXPECT_NEAR(signed_volume(mesh), 64000, 0.2 * 64000);
}

/// Positions on quarters stay what they are when they are moved far away.
TEST(surface, is_the_same_far_from_the_origin) {
  const SurfaceConfig config{.voxel_size = 0.25f};
  const Vec3 far(65536, -131072, 32768);
  const Mesh near_mesh = surface(cube_points(8, 1), 1, config);
  const Mesh far_mesh = surface(cube_points(8, 1, far), 1, config);
  expect_sound(near_mesh, 1);
  EXPECT_EQ(why_not_closed(far_mesh), "");
  ASSERT_EQ(far_mesh.triangles, near_mesh.triangles);
  for (std::size_t v = 0; v < near_mesh.vertices.size(); ++v)
    ASSERT_LT((far_mesh.vertices[v] - far - near_mesh.vertices[v]).norm(), 0.02f);
}

TEST(surface, same_bits_for_any_thread_count) {
  const std::vector<Vec3> points = ball_points(9, 0.3f);
  const Mesh one = surface(points, 1, {}, 1);
  const auto same = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
  };
  for (const int threads : {2, 3}) {
    const Mesh other = surface(points, 1, {}, threads);
    EXPECT_TRUE(same(one.vertices, other.vertices)) << threads;
    EXPECT_TRUE(same(one.normals, other.normals)) << threads;
    EXPECT_EQ(one.triangles, other.triangles) << threads;
  }
}

TEST(surface, refuses_grids_that_are_too_large) {
  const std::vector<Vec3> cube = cube_points(4, 1);
  expect_words(config_error([&] { surface(cube, 1, {.voxel_size = 1e-4f}); }),
               {"surface.voxel_size", "0.0001", "GiB", "surface.memory_limit allows 4 GiB"});
  expect_words(config_error([&] { surface(cube, 1, {.voxel_size = 1e-30f}); }),
               {"surface.voxel_size", "1e-30"});
  expect_words(config_error([&] { surface(cube, 1e30f, {.voxel_size = 1}); }), {"surface.voxel_size"});
  expect_words(config_error([&] { surface(cube, 1, {.memory_limit = 1e-4f}); }),
               {"surface.memory_limit allows 0.0001 GiB"});
  const std::vector<Vec3> apart{{0, 0, 0}, {1e9f, 0, 0}};
  expect_words(config_error([&] { surface(apart, 1, {.voxel_size = 0.5f}); }), {"voxels long", "4194304"});
}

TEST(surface, refuses_bad_values_and_says_which) {
  std::vector<Vec3> points = cube_points(3, 1);
  points[11].z() = std::numeric_limits<float>::infinity();
  expect_words(config_error([&] {
                 surface(points, 1, {.voxels = 4, .kernel_radius = 9, .particle_radius = 0, .smoothing = 101},
                         -2);
               }),
               {"surface.voxels: 4", "surface.kernel_radius: 9", "surface.particle_radius: 0",
                "surface.smoothing: 101", "threads: -2"});
  expect_words(config_error([&] { surface(points, -1, {}); }),
               {"positions[11]", "inf", "bodies[0].spacing: -1"});
  points[11].z() = 0;
  const std::vector<Vec3> few(3, Vec3(0, 0, 0));
  using Rows = Simulation::Rows;
  const std::vector<ParticleId> ids(4);
  const std::vector<SurfaceBody> bodies{{.spacing = 1, .rows = Rows{0, 20}},
                                        {.spacing = 0, .rows = Rows{9, 28}},
                                        {.spacing = 1, .rows = Rows{5, 4}}};
  expect_words(config_error([&] {
                 Surfacer({}).draw({points, few, bodies, ids});
               }),
               {"velocities: 3 are not allowed", "ids: 4 are not allowed", "27", "bodies[1].spacing: 0",
                "bodies[1].rows: 9 to 28 are not allowed", "bodies[2].rows: 5 to 4 are not allowed",
                "bodies[1].rows: some are those of bodies[0] too"});
  expect_words(config_error([&] { Surfacer({}).draw({points, {}, {}}); }), {"bodies: there is none"});
  std::vector<ParticleId> numbers(points.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  numbers[3] = 4;
  expect_words(config_error([&] {
                 Surfacer({}).draw({points, {}, {{.spacing = 1}}, numbers});
               }),
               {"ids", "are not distinct"});
  numbers[3] = 1u << 28;
  expect_words(config_error([&] {
                 Surfacer({}).draw({points, {}, {{.spacing = 1}}, numbers});
               }),
               {"ids: 268435456 is not allowed: below 268435456"});
  expect_words(config_error([&] { surface({}, 1, {.voxel_size = 0.0f}); }), {"surface.voxel_size: 0"});
  for (const float share : {0.4f, 16.5f, std::numeric_limits<float>::quiet_NaN()})
    expect_words(config_error([&] { surface({}, 1, {.voxels_per_spacing = share}); }),
                 {"surface.voxels_per_spacing: ", "is not allowed: a number in [0.5, 16]"});
}

}  // namespace surface_test
}  // namespace mallow

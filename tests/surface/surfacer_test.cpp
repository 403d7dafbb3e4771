#include <cstring>
#include <functional>
#include <random>

#include "mallow/body.h"
#include "mallow/surface.h"
#include "manifold.h"
#include "meshes.h"

namespace mallow {
namespace surfacer_test {

std::vector<Vec3> scattered(std::size_t n, float side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> inside(0, side);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(inside(random), inside(random), inside(random));
  return points;
}

std::vector<Vec3> ball(float radius, float jitter = 0, const Vec3& center = {0, 0, 0}) {
  return sample(sphere_shape(center, radius), {.spacing = 1.0f, .jitter = jitter}).positions;
}

/// Rows before `first` are of body 0, the others of body 1.
std::vector<SurfaceBody> two_bodies(std::size_t first, std::size_t count, float spacing_0, float spacing_1) {
  return {{.spacing = spacing_0, .body = 0, .rows = Simulation::Rows{0, first}},
          {.spacing = spacing_1, .body = 1, .rows = Simulation::Rows{first, count}}};
}

constexpr SurfaceKind k_kinds[] = {SurfaceKind::blended, SurfaceKind::anisotropic, SurfaceKind::spheres};

TEST(surfacer, meshes_are_manifold_also_where_voxels_are_too_coarse_to_tell_parts_from_each_other) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    for (const SurfaceKind kind : k_kinds) {
      for (const float voxel : {0.2f, 0.45f, 0.9f}) {
        const Mesh mesh = surface(scattered(300, 9, seed), 1, {.voxel_size = voxel, .kind = kind});
        ASSERT_EQ(why_not_manifold(mesh), "") << seed << ' ' << voxel;
      }
    }
  }
}

TEST(surfacer, error_of_a_sphere_falls_with_the_square_of_the_voxel_size) {
  double last = 0;
  for (const float voxel : {0.2f, 0.1f, 0.05f, 0.025f}) {
    const Mesh mesh = surface(std::vector<Vec3>{{0.01f, 0.02f, 0.03f}}, 1,
                              {.voxel_size = voxel, .kind = SurfaceKind::spheres});
    double worst = 0;
    for (const Vec3& x : mesh.vertices)
      worst = std::max(worst, std::abs(static_cast<double>((x - Vec3(0.01f, 0.02f, 0.03f)).norm()) - 0.55));
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / worst), 2, 0.4) << voxel;
    }
    last = worst;
  }
}

TEST(surfacer, surface_of_a_sampled_shape_at_rest_coincides_with_it) {
  const ImplicitShape moai = moai_shape();
  const Body body = sample(moai, {.count = 3764});
  const Mesh mesh = surface(body.positions, body.spacing, {.voxels = 192});
  EXPECT_EQ(why_not_manifold(mesh), "");
  double sum = 0;
  for (const Vec3& x : mesh.vertices) sum += std::abs(static_cast<double>(moai.distance(x)));
  EXPECT_LT(sum / static_cast<double>(mesh.vertices.size()), 0.25 * static_cast<double>(body.spacing));
}

TEST(surfacer, a_crowd_in_one_point_is_drawn_like_a_few) {
  std::vector<Vec3> crowd(100000, Vec3(1, 2, 3));
  const SurfaceConfig config{.voxel_size = 0.1f};
  const Mesh mesh = surface(crowd, 1, config);
  EXPECT_EQ(why_not_manifold(mesh), "");
  for (const Vec3& x : mesh.vertices) ASSERT_NEAR((x - Vec3(1, 2, 3)).norm(), 0.56f, 0.04f);
}

TEST(surfacer, million_metres_from_the_origin_meshes_stay_sound) {
  std::vector<Vec3> points;
  for (const Vec3& x : ball(4)) points.push_back(x + Vec3(1e6f, -1e6f, 1e6f));
  const Mesh mesh = surface(points, 1, {.voxel_size = 0.5f});
  EXPECT_EQ(why_not_closed(mesh), "");
  EXPECT_EQ(component_count(mesh), 1u);
}

TEST(surfacer, refuses_what_would_take_more_memory_than_allowed_and_says_how_much) {
  const std::string error =
      config_error([&] { surface(ball(8), 1, {.voxel_size = 0.01f, .memory_limit = 0.5f}); });
  expect_words(error,
               {"surface.voxel_size", "0.01 m", "at least", "GiB", "surface.memory_limit allows 0.5 GiB"});
}

TEST(surfacer, vertices_move_with_the_particles) {
  const std::vector<Vec3> points = ball(5);
  Surfacer surfacer({.voxels = 64});
  std::vector<Vec3> velocities(points.size(), Vec3(1, -2, 3));
  const Mesh& still = surfacer.draw({points, velocities, {{.spacing = 1}}});
  ASSERT_EQ(still.velocities.size(), still.vertices.size());
  for (const Vec3& v : still.velocities) ASSERT_LT((v - Vec3(1, -2, 3)).norm(), 1e-5f);

  const Vec3 spin(0, 0, 1);
  for (std::size_t i = 0; i < points.size(); ++i) velocities[i] = spin.cross(points[i]);
  const Mesh& turning = surfacer.draw({points, velocities, {{.spacing = 1}}});
  for (std::size_t v = 0; v < turning.vertices.size(); ++v) {
    // The mean of the particles near a vertex lies about a spacing deeper than it.
    ASSERT_LT((turning.velocities[v] - spin.cross(turning.vertices[v])).norm(), 1.3f);
    ASSERT_NEAR(turning.velocities[v].z(), 0, 1e-5f);
  }
  EXPECT_TRUE(surfacer.draw({points, {}, {{.spacing = 1}}}).velocities.empty());
}

TEST(surfacer, bodies_have_surfaces_of_their_own_or_one_that_they_share) {
  std::vector<Vec3> points = ball(4);
  const std::size_t first = points.size();
  for (const Vec3& x : ball(4, 0, {8, 0, 0})) points.push_back(x);
  const std::vector<SurfaceBody> bodies = two_bodies(first, points.size(), 1, 1);
  Surfacer apart({.voxel_size = 0.25f}), joined({.voxel_size = 0.25f, .joined = true});
  const Mesh two = apart.draw({points, {}, bodies});
  EXPECT_EQ(why_not_manifold(two), "");
  EXPECT_EQ(component_count(two), 2u);
  const Mesh one = joined.draw({points, {}, bodies});
  EXPECT_EQ(why_not_manifold(one), "");
  EXPECT_EQ(component_count(one), 1u);
  for (const Mesh* mesh : {&two, &one}) {
    ASSERT_EQ(mesh->material_ids.size(), mesh->vertices.size());
    for (std::size_t v = 0; v < mesh->vertices.size(); ++v) {
      const float x = mesh->vertices[v].x();
      if (std::abs(x - 4) < 0.7f) continue;
      ASSERT_EQ(mesh->material_ids[v], x > 4) << x;
    }
  }
}

/// The vertices on one side of a plane, in the order of the mesh.
struct PartOfMesh {
  std::vector<Vec3> vertices, normals, velocities;
  bool operator==(const PartOfMesh&) const = default;
};
PartOfMesh part_of(const Mesh& mesh, const std::function<bool(const Vec3&)>& is_in) {
  PartOfMesh part;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_in(mesh.vertices[v])) continue;
    part.vertices.push_back(mesh.vertices[v]);
    part.normals.push_back(mesh.normals[v]);
    part.velocities.push_back(mesh.velocities[v]);
  }
  return part;
}

TEST(surfacer, what_stands_still_keeps_every_bit_of_its_mesh_while_something_flies_off) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> jitter(-0.15f, 0.15f), speed(-1, 1);
  std::vector<Vec3> cube, velocities;
  for (const Vec3& x : sample(Lattice{.count = {6, 6, 6}, .spacing = 0.1f, .jitter = 0}).positions) {
    cube.push_back(x + 0.1f * Vec3(jitter(random), jitter(random), jitter(random)));
    velocities.emplace_back(speed(random), speed(random), speed(random));
  }
  const std::vector<Vec3> ball_points = ball(2);
  velocities.resize(cube.size() + ball_points.size(), Vec3(1, 2, 3));
  // As a scene says nothing, where sums are interpolated, and with all that follows the mesh.
  for (const SurfaceConfig& config :
       {SurfaceConfig{}, SurfaceConfig{.voxels_per_spacing = 6}, SurfaceConfig{.voxels_per_spacing = 11.3f},
        SurfaceConfig{.voxel_size = 0.03f}, SurfaceConfig{.kind = SurfaceKind::spheres},
        SurfaceConfig{.adaptivity = 0.2f, .smoothing = 3}}) {
    Surfacer surfacer(config);
    PartOfMesh first;
    for (const Vec3& away : {Vec3(1, 0, 0), Vec3(1.37f, 0.1f, 0.02f), Vec3(0, 0, -1),
                             Vec3(-1.7f, -2.2f, -0.9f), Vec3(7, 1, 3), Vec3(-200, 30, 1000)}) {
      std::vector<Vec3> points = cube;
      for (const Vec3& x : ball_points) points.push_back(Vec3(0.3f, 0.3f, 0.3f) + away + 0.1f * x);
      const Mesh& mesh = surfacer.draw({points, velocities, {{.spacing = 0.1f}}});
      const PartOfMesh part = part_of(
          mesh, [](const Vec3& x) { return (x - Vec3(0.3f, 0.3f, 0.3f)).cwiseAbs().maxCoeff() < 0.45f; });
      if (first.vertices.empty()) first = part;
      ASSERT_GT(part.vertices.size(), 100u);
      EXPECT_TRUE(part == first) << "the ball is " << away.transpose() << " away";
    }
  }
}

TEST(surfacer, voxels_follow_the_spacing_and_not_the_box) {
  std::vector<Vec3> points = ball(4);
  const Mesh alone = surface(points, 1, {});
  EXPECT_EQ(alone.vertices, surface(points, 1, {.voxel_size = 1.0f / 2.7f}).vertices);
  EXPECT_NEAR(static_cast<double>(surface(points, 1, {.voxels_per_spacing = 5.4f}).vertices.size()),
              4 * static_cast<double>(alone.vertices.size()),
              0.1 * static_cast<double>(alone.vertices.size()));
  // The same body in millimetres.
  std::vector<Vec3> small = points;
  for (Vec3& x : small) x *= 0.001953125f;
  EXPECT_EQ(surface(small, 0.001953125f, {}).vertices.size(), alone.vertices.size());
}

TEST(surfacer, each_body_has_voxels_for_its_own_spacing_and_joined_ones_for_the_widest) {
  const std::vector<Vec3> coarse = ball(4);
  std::vector<Vec3> fine, points = coarse;
  for (const Vec3& x : ball(4)) fine.push_back(0.25f * x + Vec3(20, 0, 0));
  points.insert(points.end(), fine.begin(), fine.end());
  const std::vector<SurfaceBody> bodies = two_bodies(coarse.size(), points.size(), 1, 0.25f);
  const Mesh both = Surfacer({}).draw({points, {}, bodies});
  std::vector<Vec3> expected = surface(coarse, 1, {}).vertices;
  for (const Vec3& x : surface(fine, 0.25f, {}).vertices) expected.push_back(x);
  EXPECT_EQ(both.vertices, expected);
  const Mesh joined = Surfacer({.joined = true}).draw({points, {}, bodies});
  EXPECT_EQ(joined.vertices,
            Surfacer({.voxel_size = 1 / 2.7f, .joined = true}).draw({points, {}, bodies}).vertices);
}

TEST(surfacer, voxels_are_counted_along_all_bodies_together) {
  std::vector<Vec3> points = ball(3);
  const std::size_t first = points.size();
  const Mesh alone = surface(points, 1, {.voxels = 64});
  points.emplace_back(100.0f, 0.0f, 0.0f);
  const Mesh both = Surfacer({.voxels = 64}).draw({points, {}, two_bodies(first, points.size(), 1, 1)});
  EXPECT_LT(both.vertices.size(), alone.vertices.size() / 50);
}

TEST(surfacer, same_bits_from_used_and_new_memory_and_for_any_thread_count) {
  const auto same = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
  };
  const std::vector<Vec3> first = ball(6, 0.3f), second = ball(5, 0.3f);
  const std::vector<Vec3> velocities(second.begin(), second.end());
  for (const SurfaceKind kind : k_kinds) {
    const SurfaceConfig config{.voxels = 64, .kind = kind, .adaptivity = 0.1f, .smoothing = 2};
    Surfacer fresh(config, 1);
    const Mesh expected = fresh.draw({second, velocities, {{.spacing = 1}}});
    for (const int threads : {1, 2, 3}) {
      Surfacer used(config, threads);
      used.draw({first, {}, {{.spacing = 1}}});
      const Mesh& mesh = used.draw({second, velocities, {{.spacing = 1}}});
      EXPECT_TRUE(same(mesh.vertices, expected.vertices)) << threads;
      EXPECT_TRUE(same(mesh.normals, expected.normals)) << threads;
      EXPECT_TRUE(same(mesh.velocities, expected.velocities)) << threads;
      EXPECT_EQ(mesh.triangles, expected.triangles) << threads;
    }
  }
}

TEST(surfacer, memory_stays_from_frame_to_frame) {
  Surfacer surfacer({.voxels = 64});
  const std::vector<Vec3> points = ball(6, 0.3f);
  surfacer.draw({points, {}, {{.spacing = 1}}});
  const std::size_t bytes = surfacer.bytes();
  EXPECT_GT(bytes, 1u << 20);
  for (int frame = 0; frame < 3; ++frame) surfacer.draw({points, {}, {{.spacing = 1}}});
  EXPECT_EQ(surfacer.bytes(), bytes);
}

/// Also where parts cannot be told from each other, and up to the largest adaptivity.
TEST(surfacer, adaptive_meshes_are_manifold) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::spheres})
      for (const float voxel : {0.12f, 0.3f, 0.7f})
        for (const float adaptivity : {0.05f, 1.0f})
          ASSERT_EQ(why_not_manifold(surface(scattered(300, 9, seed), 1,
                                             {.voxel_size = voxel, .kind = kind, .adaptivity = adaptivity})),
                    "")
              << seed << ' ' << voxel << ' ' << adaptivity;
}

TEST(surfacer, adaptive_meshes_have_few_triangles_on_flat_faces_and_stay_within_their_tolerance) {
  std::vector<Vec3> cube;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 12; ++k) cube.push_back(Eigen::Vector3i(i, j, k).cast<float>());
  constexpr float k_voxel = 0.15f;
  const Mesh fine = surface(cube, 1, {.voxel_size = k_voxel});
  std::size_t last = fine.triangles.size();
  for (const float adaptivity : {0.02f, 0.1f, 0.5f}) {
    const Mesh mesh = surface(cube, 1, {.voxel_size = k_voxel, .adaptivity = adaptivity});
    EXPECT_EQ(why_not_manifold(mesh), "") << adaptivity;
    EXPECT_LT(mesh.triangles.size(), last) << adaptivity;
    last = mesh.triangles.size();
    EXPECT_NEAR(signed_volume(mesh) / signed_volume(fine), 1, 0.002 + 0.02 * static_cast<double>(adaptivity));
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 normal = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
      ASSERT_GT(normal.dot(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]), 0) << adaptivity;
    }
    // The nearest vertex of the fine mesh is nearly half a voxel away along the surface.
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 5) {
      float nearest = 1e9f, height = 0;
      for (std::size_t u = 0; u < fine.vertices.size(); ++u) {
        const Vec3 d = mesh.vertices[v] - fine.vertices[u];
        if (d.squaredNorm() >= nearest) continue;
        nearest = d.squaredNorm();
        height = d.dot(fine.normals[u]);
      }
      ASSERT_LT(std::abs(height), (adaptivity + 0.05f) * k_voxel) << adaptivity;
    }
  }
  EXPECT_LT(last, fine.triangles.size() / 8);
}

TEST(surfacer, smoothing_evens_out_bumps_and_keeps_the_volume) {
  std::vector<Vec3> points = ball(6);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> offset(-0.4f, 0.4f);
  for (Vec3& x : points) x += Vec3(offset(random), offset(random), offset(random));
  const auto roughness = [](const Mesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
      sum += 2 -
             static_cast<double>(mesh.normals[a].dot(mesh.normals[b]) + mesh.normals[b].dot(mesh.normals[c]));
    return sum / static_cast<double>(mesh.triangles.size());
  };
  const Mesh rough = surface(points, 1, {.voxel_size = 0.4f}),
             even = surface(points, 1, {.voxel_size = 0.4f, .smoothing = 40});
  EXPECT_EQ(why_not_closed(even), "");
  EXPECT_LT(roughness(even), 0.7 * roughness(rough));
  EXPECT_NEAR(signed_volume(even) / signed_volume(rough), 1, 0.005);
}

}  // namespace surfacer_test
}  // namespace mallow

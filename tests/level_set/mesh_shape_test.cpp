#include <limits>

#include "mallow/level_set.h"
#include "meshes.h"

namespace mallow {
namespace mesh_shape_test {

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

std::size_t points_in(const ImplicitShape& shape, float spacing = 0.1f) {
  return sample(shape, {.spacing = spacing, .jitter = 0}).positions.size();
}

/// All notes of a shape in one text.
std::string notes_of(const ImplicitShape& shape) {
  std::string text;
  for (const std::string& note : shape.notes) text += note + '\n';
  return text;
}

const Mesh k_outer = box_mesh({0, 0, 0}, {2, 2, 2}),
           k_inner = box_mesh({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f});

TEST(mesh_shape, a_shell_within_another_that_faces_the_other_way_is_a_cavity) {
  const ImplicitShape hollow = mesh_shape(together({k_outer, turned(k_inner)}), k_voxels);
  EXPECT_EQ(points_in(hollow), 7000u);
  EXPECT_NEAR(*hollow.volume, 7, 1e-5);
  EXPECT_GT(hollow.distance({1, 1, 1}), 0);
  expect_words(notes_of(hollow), {"a shell within another faces the other way: kept as a cavity"});
  // A body within the cavity, and a cavity in that.
  const ImplicitShape matryoshka =
      mesh_shape(together({k_outer, turned(k_inner), box_mesh({0.6f, 0.6f, 0.6f}, {1.4f, 1.4f, 1.4f}),
                           turned(box_mesh({0.8f, 0.8f, 0.8f}, {1.2f, 1.2f, 1.2f}))}),
                 k_voxels);
  EXPECT_EQ(points_in(matryoshka), 7000u + 512u - 64u);
  expect_words(notes_of(matryoshka), {"2 shells within another face the other way: kept as cavities"});
}

TEST(mesh_shape, a_shell_within_another_that_faces_the_same_way_is_filled_with_it) {
  const ImplicitShape full = mesh_shape(together({k_outer, k_inner}), k_voxels);
  EXPECT_EQ(points_in(full), 8000u);
  EXPECT_NEAR(*full.volume, 8, 0.1);
  expect_words(notes_of(full), {"lie within each other and face the same way: filled as one"});
}

TEST(mesh_shape, overlapping_shells_are_one_body) {
  const ImplicitShape both = mesh_shape(together({k_outer, box_mesh({1, 0, 0}, {3, 2, 2})}), 96);
  EXPECT_EQ(points_in(both), 12000u);
  EXPECT_NEAR(*both.volume, 12, 0.15);
  expect_words(notes_of(both), {"overlap"});
  // Walls that overlap leave the room between them empty, though it is out of reach from outside.
  const ImplicitShape room =
      mesh_shape(together({box_mesh({0, 0, 0}, {2, 2, 0.5f}), box_mesh({0, 0, 1.5f}, {2, 2, 2}),
                           box_mesh({0, 0, 0.2f}, {2, 0.5f, 1.8f}), box_mesh({0, 1.5f, 0.2f}, {2, 2, 1.8f}),
                           box_mesh({0, 0.2f, 0.2f}, {0.5f, 1.8f, 1.8f}),
                           box_mesh({1.5f, 0.2f, 0.2f}, {2, 1.8f, 1.8f})}),
                 k_voxels);
  EXPECT_EQ(points_in(room), 7000u);
}

TEST(mesh_shape, shells_beside_each_other_are_separate_and_need_no_words) {
  const ImplicitShape both =
      mesh_shape(together({k_inner, box_mesh({2.5f, 0.5f, 0.5f}, {3.5f, 1.5f, 1.5f})}), k_voxels);
  EXPECT_EQ(points_in(both), 2000u);
  EXPECT_NEAR(*both.volume, 2, 1e-5);
  EXPECT_EQ(notes_of(both), "");
}

TEST(mesh_shape, what_is_inside_out_is_turned) {
  const ImplicitShape cube = mesh_shape(turned(k_outer), k_voxels);
  EXPECT_EQ(points_in(cube), 8000u);
  EXPECT_NEAR(*cube.volume, 8, 1e-5);
  expect_words(notes_of(cube), {"the mesh is inside out: its triangles were turned"});
  const ImplicitShape hollow = mesh_shape(together({turned(k_outer), k_inner}), k_voxels);
  EXPECT_EQ(points_in(hollow), 7000u) << "what lies within is turned too";
  const ImplicitShape pair =
      mesh_shape(together({k_inner, turned(box_mesh({2.5f, 0.5f, 0.5f}, {3.5f, 1.5f, 1.5f}))}), k_voxels);
  EXPECT_EQ(points_in(pair), 2000u);
  expect_words(notes_of(pair), {"a shell of the mesh is inside out and not within another: turned"});
}

TEST(mesh_shape, single_triangles_that_face_the_wrong_way_are_turned) {
  Mesh mesh = together({k_outer, turned(k_inner)});
  for (const std::size_t t : {1u, 5u, 14u}) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const ImplicitShape hollow = mesh_shape(mesh, k_voxels);
  EXPECT_EQ(points_in(hollow), 7000u);
  expect_words(notes_of(hollow), {"3 triangles face another way than most of their neighbours: turned"});
}

TEST(mesh_shape, without_an_outside_that_triangles_agree_on_lines_that_cross_it_count) {
  // Two cubes with a wall between them, which faces the same way for both.
  Mesh mesh = together({box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 0, 0}, {2, 1, 1})});
  for (const std::size_t t : {20u, 21u}) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const ImplicitShape cubes = mesh_shape(mesh, k_voxels);
  EXPECT_EQ(points_in(cubes), 2000u);
  EXPECT_NEAR(*cubes.volume, 2, 0.05);
  expect_words(notes_of(cubes), {"do not agree on which side is outside", "odd number"});
}

TEST(mesh_shape, bodies_that_touch_along_an_edge_are_shells_of_their_own) {
  Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  const Mesh other = turned(box_mesh({1, 1, 0}, {2, 2, 1}));
  const std::uint32_t vertex[] = {3, 8, 9, 10, 7, 11, 12, 13};
  for (const std::uint32_t v : {1u, 2u, 3u, 5u, 6u, 7u}) mesh.vertices.push_back(other.vertices[v]);
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({vertex[a], vertex[b], vertex[c]});
  const ImplicitShape cubes = mesh_shape(mesh, k_voxels);
  EXPECT_EQ(points_in(cubes), 2000u);
  EXPECT_NEAR(*cubes.volume, 2, 1e-5);
  expect_words(notes_of(cubes), {"a shell of the mesh is inside out and not within another: turned"});
}

TEST(mesh_shape, faces_with_corners_of_their_own_are_welded_and_slivers_dropped) {
  Mesh mesh;
  for (const auto& triangle : k_outer.triangles)
    for (const std::uint32_t v : triangle) mesh.vertices.push_back(k_outer.vertices[v]);
  for (std::uint32_t t = 0; t < k_outer.triangles.size(); ++t)
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  mesh.vertices.push_back(mesh.vertices[0]);
  mesh.triangles.push_back({0, 36, 1});
  EXPECT_EQ(points_in(mesh_shape(mesh, k_voxels)), 8000u);
  mesh.triangles.pop_back();
  mesh.vertices[0].x() += 1e-5f;
  expect_words(config_error([&] { mesh_shape(mesh, k_voxels); }),
               {"open edges, the first from (", "corners of open edges only ", "may be meant to be one"});
}

TEST(mesh_shape, points_of_walls_thinner_than_the_spacing_are_noted_as_too_few) {
  // A cup: walls of 0.05 round and below, open at the top.
  const Mesh cup = together({k_outer, turned(box_mesh({0.05f, 0.05f, 0.05f}, {1.95f, 1.95f, 1.9999f}))});
  const ImplicitShape shape = mesh_shape(cup);
  const Body thin = sample(shape, {.spacing = 0.1f, .jitter = 0});
  ASSERT_EQ(thin.notes.size(), 2u);
  expect_words(thin.notes[1], {"points with spacing 0.1 stand for a volume of ", "but the shape's is 0.96",
                               "too large for its size, or for its thin parts; with "});
  EXPECT_EQ(sample(shape, {.spacing = 0.025f, .jitter = 0}).notes.size(), 1u);
  EXPECT_TRUE(sample(mesh_shape(k_outer, k_voxels), {.spacing = 0.1f}).notes.empty());
  // The volume follows a placement.
  EXPECT_EQ(sample(place(shape, {.size = 20}), {.spacing = 0.25f, .jitter = 0}).notes.size(), 1u);
  EXPECT_EQ(sample(place(shape, {.size = 20}), {.spacing = 1, .jitter = 0}).notes.size(), 2u);
}

TEST(mesh_shape, a_foam_of_many_cavities_keeps_them_all) {
  Mesh foam = box_mesh({0, 0, 0}, {20, 20, 20});
  for (int i = 0; i < 1000; ++i) {
    const Vec3 low = 2 * Eigen::Vector3i(i % 10, i / 10 % 10, i / 100).cast<float>() + Vec3::Constant(0.5f);
    append(foam, turned(box_mesh(low, low + Vec3::Ones())));
  }
  const ImplicitShape shape = mesh_shape(foam, 80);
  EXPECT_EQ(points_in(shape, 0.5f), 56000u);
  EXPECT_NEAR(*shape.volume, 7000, 0.01);
  expect_words(notes_of(shape), {"1000 shells within another face the other way: kept as cavities"});
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
  expect_words(config_error([&] { mesh_shape(mesh, 4); }), {"voxels: 4", "in [8, 2048]"});
  expect_words(config_error([&] { mesh_shape(mesh, 64, -1); }), {"threads: -1"});
  mesh.vertices[7].y() = std::numeric_limits<float>::quiet_NaN();
  expect_words(config_error([&] { mesh_shape(mesh); }), {"mesh.vertices[7]", "nan", "finite"});
}

}  // namespace mesh_shape_test
}  // namespace mallow

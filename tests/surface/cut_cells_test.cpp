#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "mallow/surface.h"
#include "manifold.h"
#include "meshes.h"

namespace mallow {
namespace cut_cells_test {

using Voxel = std::array<int, 3>;

/// A mesh of any voxels: each has a sphere around it that reaches no other one.
Mesh mesh_of(const std::set<Voxel>& inside, int threads = 1) {
  std::vector<Vec3> points;
  for (const auto& [x, y, z] : inside)
    points.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  return surface(points, 1, {.voxel_size = 1, .kind = SurfaceKind::spheres}, threads);
}

/// Edges of the grid with one end inside.
std::size_t cut_edges(const std::set<Voxel>& inside) {
  std::size_t count = 0;
  for (const Voxel& voxel : inside)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        Voxel next = voxel;
        next[axis] += step;
        count += inside.contains(next) ? 0 : 1;
      }
  return count;
}

std::set<Voxel> random_voxels(double share, int side, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution inside(share);
  std::set<Voxel> voxels{{0, 0, 0}};
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        if (inside(random)) voxels.insert({x, y, z});
  return voxels;
}

/// Five voxels from one to the next, so that they lie across the borders of blocks in all ways.
TEST(cut_cells, mesh_of_every_case_of_a_cell_is_closed_and_manifold) {
  std::set<Voxel> inside;
  for (int cell = 1; cell < 256; ++cell)
    for (int c = 0; c < 8; ++c)
      if ((cell >> c & 1) != 0)
        inside.insert(
            {5 * (cell >> 5) + (c >> 2), 5 * (cell >> 2 & 7) + (c >> 1 & 1), 5 * (cell & 3) + (c & 1)});
  const Mesh mesh = mesh_of(inside);
  EXPECT_EQ(why_not_manifold(mesh), "");
  EXPECT_EQ(mesh.triangles.size(), 2 * cut_edges(inside));
}

TEST(cut_cells, meshes_of_any_voxels_are_closed_and_manifold_and_have_a_quad_for_each_edge) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    for (const double share : {0.02, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 0.98}) {
      const std::set<Voxel> inside = random_voxels(share, 19, seed);
      const Mesh mesh = mesh_of(inside);
      ASSERT_EQ(why_not_manifold(mesh), "") << share;
      ASSERT_EQ(mesh.triangles.size(), 2 * cut_edges(inside)) << share;
    }
  }
}

/// Where vertices are, in about thousandths of a voxel: no place of one is halfway between two of these.
std::multiset<Voxel> places_of(const Mesh& mesh, const Vec3& shift) {
  std::multiset<Voxel> all;
  for (const Vec3& vertex : mesh.vertices) {
    const Eigen::Vector3d place = 997.13 * (vertex - shift).cast<double>();
    all.insert({static_cast<int>(std::lround(place.x())), static_cast<int>(std::lround(place.y())),
                static_cast<int>(std::lround(place.z()))});
  }
  return all;
}

TEST(cut_cells, vertices_do_not_know_where_blocks_end) {
  const std::set<Voxel> inside = random_voxels(0.4, 11, 7);
  const std::multiset<Voxel> expected = places_of(mesh_of(inside), Vec3(0, 0, 0));
  for (int shift = 1; shift < 8; ++shift) {
    std::set<Voxel> shifted;
    for (const auto& [x, y, z] : inside) shifted.insert({x + shift, y + 2 * shift, z + 3 * shift});
    const Mesh moved = mesh_of(shifted);
    EXPECT_EQ(why_not_manifold(moved), "");
    EXPECT_TRUE(places_of(moved, Eigen::Vector3i(shift, 2 * shift, 3 * shift).cast<float>()) == expected)
        << shift;
  }
}

TEST(cut_cells, meshes_of_any_voxels_have_the_same_bits_for_any_thread_count_and_when_drawn_again) {
  const std::set<Voxel> inside = random_voxels(0.5, 30, 3);
  const Mesh one = mesh_of(inside, 1);
  const auto same = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
  };
  for (const int threads : {1, 2, 3, 7}) {
    const Mesh other = mesh_of(inside, threads);
    EXPECT_TRUE(same(one.vertices, other.vertices)) << threads;
    EXPECT_TRUE(same(one.normals, other.normals)) << threads;
    EXPECT_EQ(one.triangles, other.triangles) << threads;
  }
}

}  // namespace cut_cells_test
}  // namespace mallow

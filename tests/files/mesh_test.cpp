#include "mallow/mesh.h"

#include <gtest/gtest.h>

#include "core/precision.h"
#include "files/file_fixture.h"

namespace mallow {
namespace mesh_test {

TEST(mesh, bounds_hold_every_vertex_and_touch_the_outermost) {
  const Aabb box = bounds(tetrahedron());
  EXPECT_EQ(box.min, Vec3(-0.3f, -0.2f, 1e-20f));
  EXPECT_EQ(box.max, Vec3(1.1f, 1e10f, 3.14159274f));
  EXPECT_EQ(bounds(Mesh{}).min, Vec3(0, 0, 0));
  EXPECT_EQ(bounds(Mesh{}).max, Vec3(0, 0, 0));
}

TEST(mesh, closed_means_an_even_number_of_triangles_at_every_edge) {
  Mesh mesh = tetrahedron();
  EXPECT_EQ(why_not_closed(mesh), "");
  mesh.triangles.push_back({1, 1, 2});
  EXPECT_EQ(why_not_closed(mesh), "") << "a triangle without an area opens nothing";
  mesh.triangles.push_back({0, 1, 3});
  EXPECT_EQ(why_not_closed(mesh), "3 open edges, the first from (" + text_of(mesh.vertices[0]) + ") to (" +
                                      text_of(mesh.vertices[1]) + ")");
  mesh.triangles = tetrahedron().triangles;
  mesh.triangles.erase(mesh.triangles.begin());
  EXPECT_EQ(why_not_closed(mesh), "3 open edges, the first from (" + text_of(mesh.vertices[0]) + ") to (" +
                                      text_of(mesh.vertices[1]) + ")");
}

TEST(mesh, without_triangles_is_not_closed) {
  EXPECT_EQ(why_not_closed(Mesh{}), "no triangles");
  Mesh flat = tetrahedron();
  flat.triangles = {{2, 2, 2}};
  EXPECT_EQ(why_not_closed(flat), "no triangles that enclose anything");
}

}  // namespace mesh_test
}  // namespace mallow

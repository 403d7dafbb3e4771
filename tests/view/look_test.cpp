#include <gtest/gtest.h>

#include <cmath>

#include "view/camera.h"
#include "view/collider_mesh.h"
#include "view/pick.h"
#include "view/slider_span.h"

namespace mallow {
namespace view_look_test {

using namespace view;

OrbitCamera camera() {
  OrbitCamera result({.eye = {3, -4, 2}, .target = {0.5f, 0.2f, 0.3f}, .field_of_view = 40},
                     {{-1, -1, 0}, {1, 1, 1}});
  result.set_aspect(1.5f);
  return result;
}

TEST(view_camera, stands_where_the_picture_was_taken_from) {
  EXPECT_LT((camera().eye() - Vec3(3, -4, 2)).norm(), 1e-5f);
  EXPECT_NEAR(camera().right().dot(camera().up()), 0, 1e-6f);
}

TEST(view_camera, a_ray_goes_through_all_that_is_drawn_at_its_place) {
  OrbitCamera eye = camera();
  eye.turn(40, -25);
  eye.zoom(1.5f);
  eye.pan(0.1f, -0.2f);
  for (const auto& [x, y] : {std::pair(0.0f, 0.0f), std::pair(0.7f, -0.4f), std::pair(-1.0f, 1.0f)}) {
    const Ray ray = eye.ray(x, y);
    for (const float distance : {1.0f, 5.0f, 20.0f}) {
      const Eigen::Vector4f clip =
          eye.projection_view() * Vec3(ray.origin + distance * ray.direction).homogeneous();
      EXPECT_NEAR(clip.x() / clip.w(), x, 2e-5f);
      EXPECT_NEAR(clip.y() / clip.w(), y, 2e-5f);
    }
  }
}

TEST(view_pick, meets_the_nearest_triangle_and_the_nearest_ball) {
  Frame frame;
  frame.mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -1, 1}, {1, -1, 1}, {0, 1, 1}};
  frame.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const Ray down{{0, 0, 5}, {0, 0, -1}};
  EXPECT_LT((pick(frame, down).value() - Vec3(0, 0, 1)).norm(), 1e-6f);
  EXPECT_FALSE(pick(frame, {{3, 0, 5}, {0, 0, -1}}));
  frame.positions = {{0, 0, 2}};
  frame.bodies = {0};
  frame.radii = {0.5f};
  EXPECT_LT((pick(frame, down).value() - Vec3(0, 0, 2.5f)).norm(), 1e-6f);
}

/// Volume that a mesh encloses; where all corners lie in the surface, a little less than the shape's.
float volume(const Mesh& mesh) {
  float sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  return sum;
}

TEST(view_collider_mesh, forms_enclose_what_they_stand_for_and_face_outwards) {
  constexpr float k_pi = 3.14159265f;
  const auto mesh = [](const Primitive& part) { return mesh_of(part, 1, {0, 0, 0}).mesh; };
  EXPECT_NEAR(volume(mesh(Sphere{{1, 2, 3}, 0.5f})), k_pi / 6, 0.01f);
  EXPECT_NEAR(volume(mesh(Box{{1, 1, 1}, {2, 3, 4}})), 6, 1e-4f);
  EXPECT_NEAR(volume(mesh(Cylinder{{0, 0, 0}, {2, 0, 0}, 0.5f})), k_pi / 2, 0.01f);
  EXPECT_NEAR(volume(mesh(Capsule{{0, 0, 0}, {0, 2, 0}, 0.5f})), k_pi / 2 + k_pi / 6, 0.02f);
  EXPECT_NEAR(volume(mesh(Cone{{0, 0, 0}, {0, 0, 3}, 1, 0})), k_pi, 0.02f);
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const float exact = 0.5f;  // of a tetrahedron of 1/6 and one of 1/3 on its slant face
  EXPECT_NEAR(volume(mesh(convex_hull(corners))), exact, 0.02f);
  EXPECT_NEAR(volume(mesh(distance_field(sphere_shape({0, 0, 0}, 1), 0.05f))), 4 * k_pi / 3, 0.06f);
}

TEST(view_slider, goes_over_the_range_and_around_the_value_where_it_has_no_end) {
  EXPECT_EQ(slider_span(between(0, 1), 0.3).high, 1);
  const SliderSpan open = slider_span(k_positive, 0.02);
  EXPECT_TRUE(open.by_factors);
  EXPECT_LT(open.low, 0.02);
  EXPECT_GT(open.low, 0);
  EXPECT_NEAR(value_at(open, 0.5), 0.02, 1e-9);
  EXPECT_LT(slider_span(k_finite, 0).low, 0);
  EXPECT_LT(slider_span(at_least(1), 3).high, 1000);
}

}  // namespace view_look_test
}  // namespace mallow

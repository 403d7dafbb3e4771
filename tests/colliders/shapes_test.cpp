#include "colliders/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "colliders/collider_archive.h"
#include "colliders/collider_checks.h"
#include "core/column.h"
#include "levels.h"
#include "oracle/signed_distance.h"
#include "shapes/random_points.h"

namespace mallow {
namespace shapes_test {

const std::vector<Primitive> k_shapes = {
    Plane{{1, -2, 3}, 2},
    Plane{{0, -4, 0}, 2},
    Sphere{{0.3f, -0.2f, 0.5f}, 1.1f},
    Sphere{{0.3f, -0.2f, 0.5f}, 1.1f, true},
    Box{{-1, -0.6f, -0.3f}, {0.8f, 1.2f, 0.9f}},
    Box{{-1, -0.6f, -0.3f}, {0.8f, 1.2f, 0.9f}, true},
    Capsule{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.7f}, 0.7f},
    Capsule{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.7f}, 0.7f, true},
    Cylinder{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.7f}, 0.8f},
    Cylinder{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.7f}, 0.8f, true},
    Cylinder{{0, 0, -1}, {0, 0, 0.5f}, 1.3f},
    Cone{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.9f}, 1.2f},
    Cone{{-0.6f, 0.2f, -0.8f}, {0.5f, -0.3f, 0.9f}, 0, 1.2f, true},
    Cone{{0.5f, -1, 0}, {0.5f, 1, 0}, 0.4f, 1.1f},
    Cone{{0.5f, -1, 0}, {0.5f, 1, 0}, 1.1f, 0.4f, true},
    convex_hull(random_points(14, Vec3::Constant(-1.1f), Vec3(1.2f, 1, 0.9f))),
    convex_hull(random_points(14, Vec3::Constant(-1.1f), Vec3(1.2f, 1, 0.9f)), true),
};

/// Calls test(shape) with each as what it is.
template <class Test>
void for_each_shape(const Test& test) {
  for (const Primitive& shape : k_shapes) std::visit(test, shape);
}

/// No whole number of lanes.
VectorColumn some_points(std::size_t count = 5001) {
  VectorColumn column(count);
  const std::vector<Vec3> points = random_points(count, Vec3::Constant(-2.5f), Vec3::Constant(2.5f));
  for (std::size_t i = 0; i < count; ++i) column.set(i, points[i]);
  return column;
}

TEST(shapes, distance_in_lanes_is_that_of_the_oracle_at_every_level) {
  const VectorColumn x = some_points();
  for_each_shape([&]<class Shape>(const Shape& shape) {
    const Eigen::Vector3d by(0.5, -0.25, 1);
    const ShapeNumbers numbers = ShapeTraits<Shape>::numbers(shape, by);
    for (const InstructionLevel level : levels()) {
      Column<float> distance(x.size());
      VectorColumn normal(x.size());
      ShapeTraits<Shape>::lanes(level).nearest(numbers, raw(x), 0, x.size(), distance.data(), raw(normal));
      for (std::size_t i = 0; i < x.size(); ++i) {
        const oracle::Distance expected = oracle::distance(shape, x.get(i).template cast<double>() - by);
        EXPECT_NEAR(static_cast<double>(distance[i]), expected.value, 2e-6);
        // Which of two edges of a hull is nearer, their squares tell to half of the digits.
        EXPECT_LT((normal.get(i).template cast<double>() - expected.normal).norm(),
                  (std::is_same_v<Shape, ConvexHull> ? 5e-4 : 1e-5));
      }
    }
  });
}

TEST(shapes, a_point_alone_has_the_bits_that_it_has_among_others) {
  const VectorColumn x = some_points(37);
  for_each_shape([&]<class Shape>(const Shape& shape) {
    const ShapeNumbers numbers = ShapeTraits<Shape>::numbers(shape, {0, 0, 0});
    for (const InstructionLevel level : levels()) {
      Column<float> distance(x.size());
      VectorColumn normal(x.size());
      ShapeTraits<Shape>::lanes(level).nearest(numbers, raw(x), 0, x.size(), distance.data(), raw(normal));
      for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_EQ(nearest(shape, x.get(i)).distance, distance[i]);
        EXPECT_EQ(nearest(shape, x.get(i)).normal, normal.get(i));
      }
    }
  });
}

// Squares of these lengths leave single precision.
TEST(shapes, distances_are_right_where_a_float_does_not_hold_their_squares) {
  for (const float size : {1e-25f, 1e-30f, 1e-38f, 1e18f, 1e25f, 1e30f}) {
    const Vec3 far = size * Vec3(1, -2, 2);
    for (const SurfacePoint& point :
         {nearest(Sphere{{0, 0, 0}, size}, far), nearest(Box{{-size, 0, -size}, {0, size, 0}}, far)}) {
      const bool sphere = point.distance < 2.5f * size;
      EXPECT_NEAR(point.distance / size, sphere ? 2 : 3, 1e-6f);
      EXPECT_LT((point.normal - Vec3(1, -2, 2) / 3).norm(), 1e-6f);
    }
  }
}

/// On an axis, at a tip, at a rim, far away: distance and a normal of unit length, whatever it points to.
TEST(shapes, have_a_distance_and_a_unit_normal_everywhere) {
  std::vector<Vec3> places = {{0, 0, 0},
                              {-0.6f, 0.2f, -0.8f},
                              {0.5f, -0.3f, 0.7f},
                              {0.5f, -0.3f, 0.9f},
                              {0.5f, -1, 0},
                              {0.5f, 0, 0},
                              {0.5f, 1, 0},
                              {1.6f, 1, 0},
                              {0.3f, -0.2f, 0.5f},
                              {0, 0, 0.5f},
                              {0, 0, 0.2f},
                              {1.3f, 0, 0.5f},
                              {-0.05f, -0.05f, -0.05f}};
  for (const float far : {1e4f, 1e10f, 1e18f, 1e30f})
    for (const Vec3& way : random_points(40, Vec3::Constant(-1), Vec3::Constant(1)))
      places.push_back(far * way);
  for (const Vec3& x : random_points(40, Vec3::Constant(-1), Vec3::Constant(1))) places.push_back(1e-30f * x);
  for_each_shape([&]<class Shape>(const Shape& shape) {
    for (const Vec3& x : places) {
      const SurfacePoint point = nearest(shape, x);
      EXPECT_TRUE(std::isfinite(point.distance)) << ShapeTraits<Shape>::k_key << " at " << x.transpose();
      EXPECT_NEAR(point.normal.norm(), 1, 1e-6f) << ShapeTraits<Shape>::k_key << " at " << x.transpose();
      const double expected = oracle::distance(shape, x.cast<double>()).value;
      EXPECT_NEAR(point.distance, expected, 4e-7 * std::max(4.0, x.cast<double>().norm()))
          << ShapeTraits<Shape>::k_key << " at " << x.transpose();
    }
  });
}

TEST(shapes, bounds_hold_all_of_the_surface_and_no_more) {
  for_each_shape([&]<class Shape>(const Shape& shape) {
    const Aabb box = bounds(shape);
    Aabb seen{Vec3::Constant(1e9f), Vec3::Constant(-1e9f)};
    for (const Vec3& x : random_points(20000, Vec3::Constant(-2.5f), Vec3::Constant(2.5f))) {
      const SurfacePoint point = nearest(shape, x);
      const Vec3 foot = x - point.distance * point.normal;
      seen.min = seen.min.cwiseMin(foot);
      seen.max = seen.max.cwiseMax(foot);
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.min[axis], seen.min[axis] + 1e-5f);
      EXPECT_GE(box.max[axis], seen.max[axis] - 1e-5f);
      if (!std::isfinite(box.min[axis])) continue;
      EXPECT_NEAR(box.min[axis], seen.min[axis], 1e-2f);
      EXPECT_NEAR(box.max[axis], seen.max[axis], 1e-2f);
    }
  });
}

TEST(shapes, no_point_of_a_block_is_nearer_than_the_least_distance) {
  const std::vector<Vec3> x = random_points(300, Vec3::Constant(-3), Vec3::Constant(3));
  for_each_shape([&]<class Shape>(const Shape& shape) {
    const ShapeNumbers numbers = ShapeTraits<Shape>::numbers(shape, {0, 0, 0});
    for (std::size_t block = 0; block < x.size(); block += 3) {
      const Vec3 min = x[block].cwiseMin(x[block + 1]), max = x[block].cwiseMax(x[block + 1]);
      const float least = ShapeTraits<Shape>::lanes(InstructionLevel::baseline)
                              .least_distance(numbers, min.data(), max.data());
      float nearest_of_all = 1e9f;
      for (const Vec3& p : random_points(400, min, max))
        nearest_of_all = std::min(nearest_of_all, nearest(shape, p).distance);
      // A box that keeps particles in is met as planes; nobody asks how far it is.
      if (ShapeTraits<Shape>::keeps_in(shape) && std::is_same_v<Shape, Box>) continue;
      EXPECT_LE(least, std::max(nearest_of_all, 0.0f) + 1e-5f);
      EXPECT_GE(least, std::min(nearest_of_all, 0.0f) - (max - min).norm());
    }
  });
}

TEST(shapes, lines_pass_the_surface_where_the_distance_is_0) {
  const std::vector<Vec3> from = random_points(200, Vec3::Constant(-3), Vec3::Constant(3));
  for_each_shape([&]<class Shape>(const Shape& shape) {
    int crossings = 0;
    for (std::size_t i = 0; i + 1 < from.size(); ++i) {
      const Vec3 direction = (from[i + 1] - from[i]).normalized();
      for (const Crossing& crossing : ShapeTraits<Shape>::cross(shape, from[i], direction)) {
        if (!std::isfinite(crossing.t)) continue;
        ++crossings;
        const SurfacePoint point = nearest(shape, from[i] + crossing.t * direction);
        EXPECT_NEAR(point.distance, 0, 1e-5f * std::max(1.0f, std::abs(crossing.t)));
        const Vec3 free = from[i] + crossing.t * direction + 1e-3f * crossing.normal;
        EXPECT_NEAR(nearest(shape, free).distance, 1e-3f, 1e-4f * std::max(1.0f, std::abs(crossing.t)));
      }
    }
    EXPECT_GT(crossings, 40);
  });
}

Collider with(const Collider::Shape& shape) {
  Collider collider{.shape = shape,
                    .velocity = {1, 2, 3},
                    .angular_velocity = {4, 5, 6},
                    .restitution = 0.25f,
                    .friction = 0.5f,
                    .measure_load = true};
  collider.pose = {{7, 8, 9}, {0.5, -0.5, 0.5, 0.5}};
  collider.keyframes = {{1, {{1, 2, 3}, {0, 0, 0, 1}}}, {2.5, {{4, 5, 6}, {1, 0, 0, 0}}}};
  return collider;
}

std::string packed(const Collider& collider) {
  PackingArchive archive;
  pass_collider(archive, collider);
  return archive.take();
}

TEST(shapes, come_back_from_an_archive) {
  std::vector<Collider::Shape> shapes{Union{k_shapes}};
  for_each_shape([&](const auto& shape) { shapes.push_back(shape); });
  for (const auto& shape : shapes) {
    const std::string bytes = packed(with(shape));
    UnpackingArchive archive("colliders", bytes);
    Collider read;
    pass_collider(archive, read);
    archive.finish();
    EXPECT_EQ(read.shape.index(), shape.index());
    EXPECT_EQ(packed(read), bytes);
    EXPECT_EQ(read.pose.rotation, Eigen::Vector4d(0.5, -0.5, 0.5, 0.5));
  }
}

TEST(shapes, of_an_unknown_kind_are_refused_in_an_archive) {
  std::string bytes = packed(with(Sphere{}));
  bytes[bytes.find("sphere")] = 'x';
  EXPECT_NE(problem_of([&] {
              UnpackingArchive archive("colliders", bytes);
              Collider read;
              pass_collider(archive, read);
            }).find("'xphere' is not a kind of shape"),
            std::string::npos);
}

std::string problem_with(const Collider& collider) {
  return problem_of([&] {
    Checks checks;
    check(collider, checks);
    checks.finish();
  });
}

TEST(shapes, that_are_wrong_are_told_by_name) {
  const float nan = std::nanf("");
  const auto expect = [](const Collider& collider, const std::string& field) {
    EXPECT_TRUE(problem_with(collider).starts_with("collider." + field + ": ")) << problem_with(collider);
  };
  for_each_shape([](const auto& shape) { EXPECT_EQ(problem_with(with(shape)), "nothing thrown"); });
  expect(with(Plane{{0, 0, 0}, 1}), "plane.normal");
  expect(with(Plane{{0, 1e-20f, 0}, 1}), "plane.normal");
  expect(with(Plane{{0, 0, 1}, nan}), "plane.offset");
  expect(with(Sphere{{nan, 0, 0}, 1}), "sphere.center");
  expect(with(Sphere{{0, 0, 0}, 0}), "sphere.radius");
  expect(with(Box{{0, 0, 0}, {1, 0, 1}}), "box.max");
  expect(with(Box{{0, -nan, 0}, {1, 1, 1}}), "box.min");
  expect(with(Capsule{{1, 2, 3}, {1, 2, 3}, 1}), "capsule.end");
  expect(with(Capsule{{0, 0, 0}, {0, 0, 1}, 0}), "capsule.radius");
  expect(with(Cylinder{{0, 0, 0}, {0, 1e16f, 0}, 1}), "cylinder.end");
  expect(with(Cylinder{{0, nan, 0}, {0, 1, 0}, 1}), "cylinder.start");
  expect(with(Cone{{0, 0, 0}, {0, 1e-16f, 0}, 1}), "cone.end");
  expect(with(Cone{{0, 0, 0}, {0, 1, 0}, 0, 0}), "cone.start_radius");
  expect(with(Cone{{0, 0, 0}, {0, 1, 0}, 1, -1}), "cone.end_radius");
  expect(with(ConvexHull{}), "hull.data");
  expect(with(DistanceField{}), "mesh.grid");
  for (const DistanceGrid& grid : {DistanceGrid{{0, 0, 0}, 1, {2, 2, 2}, {1, 2, 3}},
                                   DistanceGrid{{0, 0, 0}, 0, {2, 2, 2}, std::vector(8, 1.0f)},
                                   DistanceGrid{{0, nan, 0}, 1, {2, 2, 2}, std::vector(8, 1.0f)},
                                   DistanceGrid{{0, 0, 0}, 1, {1, 2, 4}, std::vector(8, 1.0f)},
                                   DistanceGrid{{0, 0, 0}, 1, {2, 2, 2}, std::vector(8, nan)}})
    expect(with(DistanceField{std::make_shared<const DistanceGrid>(grid)}), "mesh.grid");
  expect(with(Union{}), "union");
  expect(with(Union{{Plane{}, Sphere{{0, 0, 0}, -1}}}), "sphere.radius");
  Collider moved = with(Plane{});
  moved.keyframes = {{1, {}}, {1, {}}};
  expect(moved, "keyframes[1].time");
  moved.keyframes = {{1, {}}, {2, {{0, 0, 0}, {0, 0, 0, 0}}}};
  expect(moved, "keyframes[1].pose.rotation");
  Collider collider = with(Plane{});
  collider.pose.rotation.setZero();
  expect(collider, "pose.rotation");
  collider = with(Plane{});
  collider.pose.translation.x() = std::nan("");
  expect(collider, "pose.translation");
  collider = with(Plane{});
  collider.angular_velocity.z() = nan;
  expect(collider, "angular_velocity");
}

TEST(bounds, of_what_stands_turned_hold_it) {
  const Pose pose = {{1, 2, 3}, {0, 0, std::sin(std::numbers::pi / 8), std::cos(std::numbers::pi / 8)}};
  const Aabb box = placed(Aabb{{-1, -1, -1}, {1, 1, 1}}, pose);
  EXPECT_LT((box.min - Vec3(1 - std::sqrt(2.0f), 2 - std::sqrt(2.0f), 2)).norm(), 1e-6f);
  EXPECT_LT((box.max - Vec3(1 + std::sqrt(2.0f), 2 + std::sqrt(2.0f), 4)).norm(), 1e-6f);
}

}  // namespace shapes_test
}  // namespace mallow

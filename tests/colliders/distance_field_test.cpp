#include "colliders/distance_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "colliders/collider_archive.h"
#include "colliders/one_row.h"
#include "core/column.h"
#include "levels.h"
#include "mallow/body.h"
#include "oracle/signed_distance.h"
#include "shapes/random_points.h"

namespace mallow {
namespace distance_field_test {

constexpr float k_voxel = 0.1f;

float torus(const Vec3& x) {
  return std::hypot(std::hypot(x.x(), x.y()) - 1.0f, x.z()) - 0.4f;
}
const Aabb k_torus_box{{-1.4f, -1.4f, -0.4f}, {1.4f, 1.4f, 0.4f}};
DistanceField torus_field(bool inside = false) {
  return distance_field({torus, k_torus_box}, k_voxel, inside);
}

/// Keeps two voxels of truth, as meshes do.
DistanceField banded_torus() {
  const float band = 2 * k_voxel;
  return distance_field(
      {[=](const Vec3& x) { return std::clamp(torus(x), -3 * k_voxel, 3 * k_voxel); }, k_torus_box}, k_voxel,
      false, band);
}

TEST(distance_field, in_lanes_is_that_of_the_oracle_at_every_level) {
  const std::vector<Vec3> points = random_points(3001, Vec3::Constant(-2.5f), Vec3::Constant(2.5f));
  VectorColumn column(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) column.set(i, points[i]);
  const VectorColumn& x = column;
  for (const DistanceField& field : {torus_field(), torus_field(true), banded_torus()}) {
    const Eigen::Vector3d by(0.5, -0.25, 1);
    const ShapeNumbers numbers = ShapeTraits<DistanceField>::numbers(field, by);
    std::vector<float> first;
    for (const InstructionLevel level : levels()) {
      std::vector<float> distance(x.size());
      VectorColumn normal(x.size());
      ShapeTraits<DistanceField>::lanes(level).nearest(numbers, raw(x), 0, x.size(), distance.data(),
                                                       raw(normal));
      int near_a_face = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const oracle::Distance expected = oracle::distance(field, points[i].cast<double>() - by);
        EXPECT_NEAR(static_cast<double>(distance[i]), expected.value, 3e-6);
        EXPECT_NEAR(normal.get(i).norm(), 1, 1e-6f);
        near_a_face += (normal.get(i).cast<double>() - expected.normal).norm() > 1e-4;
      }
      EXPECT_LT(near_a_face, 10);  // the gradient jumps there
      if (first.empty()) first = distance;
      EXPECT_EQ(distance, first);
    }
  }
}

TEST(distance_field, is_the_distance_that_it_was_sampled_from) {
  for (const DistanceField& field : {torus_field(), banded_torus()}) {
    for (const Vec3& x : random_points(5000, k_torus_box.min, k_torus_box.max)) {
      const SurfacePoint point = nearest(field, x);
      if (std::abs(torus(x)) < 1.9f * k_voxel) {
        EXPECT_NEAR(point.distance, torus(x), 0.1f * k_voxel);
      }
      // Never longer, so that whoever goes so far does not pass the surface; in the middle it has a crease.
      if (torus(x) > 0) {
        EXPECT_LT(point.distance, torus(x) + 0.05f * k_voxel);
      }
    }
    for (const Vec3& x : random_points(5000, Vec3::Constant(-9), Vec3::Constant(9)))
      if (torus(x) > 0) {
        EXPECT_LT(nearest(field, x).distance, torus(x) + 0.05f * k_voxel);
      }
    const Aabb box = bounds(field);
    EXPECT_LT((box.min - k_torus_box.min).norm(), 0.05f * k_voxel);
    EXPECT_LT((box.max - k_torus_box.max).norm(), 0.05f * k_voxel);
  }
}

TEST(distance_field, normals_are_gradients_and_lead_towards_the_surface) {
  const DistanceField field = torus_field();
  for (const Vec3& x : random_points(3000, k_torus_box.min, k_torus_box.max)) {
    if (std::abs(torus(x)) > 2 * k_voxel || std::hypot(x.x(), x.y()) < 0.3f) continue;
    const SurfacePoint point = nearest(field, x);
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis)
      gradient[axis] = (torus(x + 1e-3f * Vec3::Unit(axis)) - torus(x - 1e-3f * Vec3::Unit(axis))) / 2e-3f;
    EXPECT_LT((point.normal - gradient).norm(), 0.3f) << x.transpose();
    EXPECT_NEAR(torus(x - point.distance * point.normal), 0, 0.2f * k_voxel) << x.transpose();
  }
}

TEST(distance_field, has_a_distance_and_a_unit_normal_everywhere) {
  std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}, {1.4f, 0, 0}, {1.7f, 1.7f, 0.7f}, {-1.7f, -1.7f, -0.7f}};
  for (const float far : {3.0f, 1e4f, 1e10f, 1e18f, 1e30f})
    for (const Vec3& way : random_points(40, Vec3::Constant(-1), Vec3::Constant(1)))
      places.push_back(far * way);
  for (const DistanceField& field : {torus_field(), torus_field(true)})
    for (const Vec3& x : places) {
      EXPECT_TRUE(std::isfinite(nearest(field, x).distance)) << x.transpose();
      EXPECT_NEAR(nearest(field, x).normal.norm(), 1, 1e-6f) << x.transpose();
    }
}

TEST(distance_field, lines_pass_it_where_the_distance_is_0) {
  const DistanceField field = torus_field();
  int crossings = 0;
  const std::vector<Vec3> from = random_points(400, Vec3::Constant(-3), Vec3::Constant(3));
  for (std::size_t i = 0; i + 1 < from.size(); ++i) {
    const Vec3 direction = (from[i + 1] - from[i]).normalized();
    if (std::abs(torus(from[i])) < k_voxel) continue;  // what starts at the surface does not meet it
    bool in = torus(from[i]) < 0;
    float before = 0;
    for (const Crossing& crossing : ShapeTraits<DistanceField>::cross(field, from[i], direction)) {
      if (!std::isfinite(crossing.t)) continue;
      ++crossings;
      EXPECT_GT(crossing.t, before);
      EXPECT_NEAR(torus(from[i] + crossing.t * direction), 0, 0.05f * k_voxel);
      EXPECT_EQ(crossing.normal.dot(direction) > 0, in);
      in = !in;
      before = crossing.t;
    }
  }
  EXPECT_GT(crossings, 100);
}

TEST(distance_field, comes_back_from_an_archive) {
  Collider collider{.shape = Union{{torus_field(true), Sphere{}}}};
  PackingArchive packing;
  pass_collider(packing, collider);
  const std::string bytes = packing.take();
  UnpackingArchive archive("colliders", bytes);
  Collider read;
  pass_collider(archive, read);
  archive.finish();
  for (const Vec3& x : random_points(100, Vec3::Constant(-2), Vec3::Constant(2)))
    EXPECT_EQ(nearest(read, x).distance, nearest(collider, x).distance);
}

// A plate one voxel thick, which lies as it likes to its grid.
TEST(distance_field, is_not_passed_by_a_fast_particle) {
  const float voxel = 0.5f;
  const ContactStep step{
      .time_step = 0.1f, .max_push = 2, .contact_offset = 0.5f, .gravity = {0, 0, 0}, .least_bounce = 0};
  for (const float shift : {0.0f, 0.1f, 0.25f, 0.4f}) {
    const Box plate{{-8, -8, shift}, {8, 8, shift + voxel}};
    const DistanceFunction distance = [&](const Vec3& x) {
      return std::clamp(nearest(plate, x).distance, -3 * voxel, 3 * voxel);
    };
    const Vec3 round(0.3f, 0.2f, std::fmod(shift, voxel));
    const Collider collider{
        .shape = distance_field({distance, {plate.min - round, plate.max}}, voxel, false, 2.9f * voxel)};
    for (const float speed : {1.0f, 20.0f, 150.0f, 1000.0f, 4000.0f}) {
      for (const Vec3& aim : random_points(200, Vec3(-6, -6, 0), Vec3(6, 6, 0))) {
        const Vec3 from(0.2f * aim.y(), -0.3f * aim.x(), shift + voxel + 0.5f + std::abs(aim.x()));
        const Vec3 coming = speed * (aim - from).normalized();
        const Vec3 end = from + step.time_step * resolve_one_row(collider, step, from, coming, coming);
        if (std::abs(end.x()) < 8 && std::abs(end.y()) < 8) {
          EXPECT_GT(end.z(), shift + voxel + 0.4f);
        }
      }
    }
  }
}

// Over the middles of its faces, where the grid knows the box exactly.
TEST(distance_field, that_stands_turned_and_turns_is_met_as_the_box_is) {
  const ContactStep step{
      .time_step = 0.1f, .max_push = 2, .contact_offset = 0.5f, .gravity = {0, 0, 0}, .least_bounce = 0};
  const Box box{{-2, -2, -2}, {2, 2, 2}};
  const DistanceFunction distance = [&](const Vec3& x) { return nearest(box, x).distance; };
  Collider sampled{.shape = distance_field({distance, {box.min, box.max}}, 0.25f),
                   .velocity = {0.5f, 0, -0.3f},
                   .angular_velocity = {0.6f, -0.9f, 0.3f},
                   .friction = 0.4f};
  sampled.pose = {{0.3, -0.1, 0.2}, {0.3, -0.2, 0.4, 0.6}};
  Collider exact = sampled;
  exact.shape = box;
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(sampled.pose.rotation).normalized().toRotationMatrix();
  int met = 0;
  for (const Vec3& at : random_points(600, Vec3(-1, -1, -3), Vec3(1, 1, 3))) {
    if (std::abs(at.z()) < 2) continue;
    const Vec3 x = (sampled.pose.translation + rotation * at.cast<double>()).cast<float>();
    const Vec3 coming = -2 * (rotation * at.cast<double>()).cast<float>();
    const Vec3 v = resolve_one_row(sampled, step, x, coming, coming);
    EXPECT_LT((v - resolve_one_row(exact, step, x, coming, coming)).norm(), 1e-4f) << at.transpose();
    met += v != coming;
  }
  EXPECT_GT(met, 100);
}

// Beside the grid distances are a bound, and matter would stop where that is half a spacing.
TEST(distance_field, is_touched_half_a_spacing_away_however_fine_its_voxels_are) {
  const Box box{{-2, -2, -2}, {2, 2, 2}};
  const DistanceFunction distance = [&](const Vec3& x) { return nearest(box, x).distance; };
  for (const float voxel : {0.5f, 0.25f, 0.1f, 0.06f}) {
    const DistanceField field = distance_field({distance, {box.min, box.max}}, voxel);
    for (const float touches : {0.1f, 0.3f, 0.5f})
      EXPECT_NEAR(nearest(field, {0.3f, -0.4f, 2 + touches}).distance, touches, 1e-6f) << voxel;
  }
}

TEST(distance_field, of_a_shape_with_too_many_voxels_is_refused) {
  EXPECT_THROW(distance_field({torus, k_torus_box}, 1e-4f), ConfigError);
  EXPECT_THROW(distance_field({torus, k_torus_box}, 0), ConfigError);
  EXPECT_THROW(distance_field({torus, k_torus_box}, 0.1f, false, -1), ConfigError);
}

}  // namespace distance_field_test
}  // namespace mallow

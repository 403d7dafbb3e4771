#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "colliders/one_row.h"
#include "colliders/pose.h"
#include "oracle/signed_distance.h"
#include "shapes/random_points.h"

namespace mallow {
namespace contact_test {

constexpr ContactStep k_step{
    .time_step = 0.1f, .max_push = 2.0f, .contact_offset = 0.5f, .gravity = {0, 0, -1}, .least_bounce = 0.2f};

/// Of a particle that nothing but the collider acts on: it comes as it would move on.
Vec3 resolve(const Collider& collider, const Vec3& x, const Vec3& v) {
  return resolve_one_row(collider, k_step, x, v, v);
}

TEST(contact, leaves_a_velocity_alone_that_does_not_reach_the_surface) {
  const Collider floor{.shape = Plane{}, .friction = 1};
  EXPECT_EQ(resolve(floor, {0, 0, 1.5f}, {3, 0, -9}), Vec3(3, 0, -9));
}

// Of every shape, from any distance, at any speed: at the end of the step it is where it touches.
TEST(contact, ends_a_step_that_would_pass_the_surface_at_the_surface) {
  const std::vector<Collider::Shape> shapes = {
      Plane{{0, 0, 2}, -3},
      Sphere{{0, 0, -3.5f}, 2},
      Sphere{{0, 0, 6}, 7.5f, true},
      Box{{-2, -2, -4}, {2, 2, -1.5f}},
      Box{{-2, -2, -1.5f}, {2, 2, 900}, true},
      Capsule{{-3, -1, -3.5f}, {3, 1, -3.5f}, 2},
      Capsule{{0, 0, 6}, {1, 1, 7}, 7.5f, true},
      Cylinder{{-3, 0, -3.5f}, {3, 0, -3.5f}, 2},
      Cylinder{{0, 0, -4}, {0, 0, -1.5f}, 2},
      Cylinder{{0, 0, -1.5f}, {0, 0, 900}, 8, true},
      Cone{{0, 0, -1.5f}, {0, 0, -4}, 2, 3},
      Cone{{0, 0, -1.5f}, {0, 0, 900}, 4, 90, true},
      convex_hull(std::vector<Vec3>{
          {-3, -3, -4}, {3, -3, -4}, {0, 4, -4}, {-3, -3, -1.5f}, {3, -3, -1.5f}, {0, 4, -1.5f}}),
      Union{{Sphere{{0, 0, -3.5f}, 2}, Plane{{0, 1, 0}, -9}}},
  };
  for (const auto& shape : shapes) {
    for (const float height : {-0.9f, 0.0f, 3.0f, 12.0f}) {
      for (const float speed : {1.0f, 30.0f, 200.0f, 1000.0f}) {
        if (height - 0.1f * speed > -1) continue;
        const Vec3 v = resolve({.shape = shape, .friction = 0.5f}, {0, 0, height}, {0, 0, -speed});
        EXPECT_NEAR(height + 0.1f * v.z(), -1, 2e-5f * std::max(1.0f, height))
            << shape.index() << " from " << height << " at " << speed;
      }
    }
  }
}

TEST(contact, lets_a_particle_by_that_passes_an_obstacle) {
  // Nearer to it than its way is long, and towards it, but aside of it.
  for (const Collider& obstacle :
       {Collider{.shape = Sphere{{0, 0, 0}, 1}}, Collider{.shape = Box{{-1, -1, -1}, {1, 1, 1}}},
        Collider{.shape = Capsule{{0, -3, 0}, {0, 3, 0}, 1}},
        Collider{.shape = Cylinder{{0, -3, 0}, {0, 3, 0}, 1}},
        Collider{.shape = Cone{{0, 0, 0}, {0, 0, 4}, 1}}})
    for (const float aside : {1.75f, 2.0f, 4.0f})
      EXPECT_EQ(resolve(obstacle, {aside, 0, 6}, {0, 0, -100}), Vec3(0, 0, -100)) << aside;
}

TEST(contact, keeps_a_particle_in_a_corner_within_all_walls_of_a_box) {
  const Collider room{.shape = Box{{-5, -5, 0}, {5, 5, 10}, true}};
  for (const float speed : {1.0f, 50.0f, 500.0f}) {
    const Vec3 x(4.4f, -4.3f, 0.6f), v = resolve(room, x, Vec3(speed, -speed, -speed));
    const Vec3 expected =
        (x + 0.1f * Vec3(speed, -speed, -speed)).cwiseMin(4.5f).cwiseMax(Vec3(-4.5f, -4.5f, 0.5f));
    EXPECT_LT((x + 0.1f * v - expected).norm(), 1e-5f);
  }
}

TEST(contact, keeps_a_particle_in_a_ball_that_it_would_cross_in_a_step) {
  const Collider ball{.shape = Sphere{{1, 2, 3}, 8, true}};
  for (const Vec3& way : {Vec3(-300, 0, 0), Vec3(90, -500, 20), Vec3(-3, 70, 70)}) {
    const Vec3 x(3, 4, 1), end = x + 0.1f * resolve(ball, x, 10.0f * way);
    EXPECT_LT((end - Vec3(1, 2, 3)).norm(), 7.5f + 1e-3f * way.norm()) << way.transpose();
  }
}

TEST(contact, bounces_relative_to_a_moving_collider_to_e_squared_of_the_height) {
  const Collider floor{.shape = Plane{}, .velocity = {1, 0, 2}, .restitution = 0.5f};
  const Vec3 v = resolve(floor, {0, 0, 0.5f}, {4, 0, -8});
  // Δt g_n/2 = 0.05: what comes with 10 passed the surface with 10.05 half a kick later.
  EXPECT_FLOAT_EQ(v.z(), 2 + std::sqrt(0.25f * 10.05f * 10.05f) - 0.05f);
  EXPECT_FLOAT_EQ(v.x(), 4);
}

TEST(contact, lets_what_comes_slowly_rest) {
  const Collider floor{.shape = Plane{}, .restitution = 1};
  EXPECT_FLOAT_EQ(resolve(floor, {0, 0, 0.5f}, {0, 0, -0.19f}).z(), 0);
  EXPECT_GT(resolve(floor, {0, 0, 0.5f}, {0, 0, -0.21f}).z(), 0.1f);
}

TEST(contact, pushes_a_deep_overlap_out_no_faster_than_allowed) {
  EXPECT_FLOAT_EQ(resolve({.shape = Plane{}}, {0, 0, -3}, {0, 0, 0}).z(), 2);
  EXPECT_FLOAT_EQ(resolve({.shape = Plane{}}, {0, 0, 0.4f}, {0, 0, 0}).z(), 1);
}

TEST(contact, friction_shrinks_the_tangential_velocity_by_the_coulomb_share) {
  const Collider floor{.shape = Plane{}, .friction = 0.25f};
  // Δw_n = 8, so |w_t| = 6 loses 2; and 1.5 is less than that, so it sticks.
  EXPECT_FLOAT_EQ(resolve(floor, {0, 0, 0.5f}, {6, 0, -8}).x(), 4);
  EXPECT_FLOAT_EQ(resolve(floor, {0, 0, 0.5f}, {1.5f, 0, -8}).x(), 0);
}

TEST(contact, friction_takes_no_more_than_what_the_step_has_not_turned_round) {
  const Collider floor{.shape = Plane{}, .friction = 1};
  // It came with 1 and would go back with -4: three quarters are left of what was turned round.
  EXPECT_FLOAT_EQ(resolve_one_row(floor, k_step, {0, 0, 0.5f}, {1, 0, 0}, {-4, 0, -8}).x(), -1);
  EXPECT_FLOAT_EQ(resolve_one_row(floor, k_step, {0, 0, 0.5f}, {6, 0, 0}, {-4, 0, -8}).x(), -4);
}

/// Contact in double, one particle, read literally: model 2, section 4 A, in the frame of the collider, which
/// stands turned on at the end of the step.
Eigen::Vector3d literal(const Collider& collider, const Vec3& x, const Vec3& before, const Vec3& v) {
  using Vec = Eigen::Vector3d;
  const double dt = static_cast<double>(k_step.time_step);
  const Eigen::Matrix3d rotation = rotation_of(collider.pose);
  Collider later = collider;
  move_colliders(0, dt, {&later, 1});
  const Eigen::Matrix3d turned = rotation_of(later.pose);
  const Vec c = collider.pose.translation;
  const Vec at = x.cast<double>();
  Vec now = v.cast<double>();
  for (const Primitive& part : oracle::parts_of(collider)) {
    const Vec r = at - c;
    const Vec u = collider.velocity.cast<double>() + mean_spin(collider.angular_velocity, dt) * r;
    const Vec way = dt * (now - u);
    const oracle::Distance met = oracle::distance_on_the_way(
        part, rotation.transpose() * r, turned.transpose() * way, static_cast<double>(k_step.contact_offset));
    const Vec n = turned * met.normal;
    const double gap = met.value - static_cast<double>(k_step.contact_offset);
    const double across = (now - u).dot(n);
    if (!(gap + dt * across < 0)) continue;
    // Of the surface under the particle: along the plane that of its foot.
    const Vec foot = mean_spin(collider.angular_velocity, dt) * (met.value * rotation * met.normal);
    const Vec under = u - (foot - foot.dot(n) * n);
    const Vec w = now - under, w_before = before.cast<double>() - under;
    const double push = static_cast<double>(k_step.max_push);
    const double target = gap >= 0 ? -gap / dt : std::min(-gap / dt, push);
    const Vec tangential = w - across * n, tangential_before = w_before - w_before.dot(n) * n;
    double taken =
        std::min(1.0, static_cast<double>(collider.friction) * (target - across) / tangential.norm());
    if (const double along = tangential.dot(tangential_before); along < 0)
      taken = std::min(taken, std::max(0.0, 1 + along / tangential.squaredNorm()));
    now = under + target * n + (1 - taken) * tangential;
  }
  return now;
}

const Box k_room{{-2, -1.5f, -1}, {2, 1.5f, 1}, true};
const std::vector<Collider::Shape> k_shapes = {
    Plane{{1, -1, 2}, -0.3f},
    Sphere{{0.2f, 0, 0.1f}, 1},
    Sphere{{0.1f, 0, 0}, 2, true},
    Box{{-1, -0.5f, -0.7f}, {1, 0.6f, 0.4f}},
    Box{k_room.min, k_room.max, true},
    Capsule{{-0.5f, 0, -0.3f}, {0.4f, 0.5f, 0.2f}, 0.6f},
    Capsule{{-0.5f, 0, -0.3f}, {0.4f, 0.5f, 0.2f}, 1.6f, true},
    Cylinder{{-0.5f, 0, -0.3f}, {0.4f, 0.5f, 0.2f}, 0.7f},
    Cylinder{{-1.5f, -1, -0.9f}, {1, 1.5f, 1.2f}, 1.5f, true},
    Cone{{-0.5f, 0, -0.3f}, {0.4f, 0.5f, 0.2f}, 1, 0.4f},
    Cone{{-1.5f, -1, -0.9f}, {1, 1.5f, 1.2f}, 2, 1, true},
    convex_hull(random_points(14, Vec3::Constant(-1), Vec3(1.2f, 1, 0.9f))),
    convex_hull(random_points(14, Vec3::Constant(-2), Vec3::Constant(2)), true),
    Union{{Sphere{{1, 0, 0}, 0.5f}, Box{{-1, -1, -1}, {0, 0, 0}}}},
};

/// However it stands, moves and turns.
TEST(contact, is_the_literal_one_in_double) {
  for (const bool turns : {false, true}) {
    for (const auto& shape : k_shapes) {
      Collider collider{.shape = shape, .velocity = {0.3f, -0.2f, 0.1f}, .friction = 0.4f};
      collider.pose.translation = {0.3, -0.1, 0.2};
      if (turns) {
        collider.pose.rotation = {0.3, -0.2, 0.4, 0.6};
        collider.angular_velocity = {0.5f, 1, -0.8f};
      }
      const std::vector<Vec3> places = random_points(400, Vec3::Constant(-2), Vec3::Constant(2));
      const std::vector<Vec3> speeds = random_points(400, Vec3::Constant(-6), Vec3::Constant(6));
      int touched = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3 coming = speeds[places.size() - 1 - i], before = 0.9f * coming;
        const Vec3 v = resolve_one_row(collider, k_step, places[i], before, coming);
        EXPECT_LT((v.cast<double>() - literal(collider, places[i], before, coming)).norm(), 5e-5)
            << shape.index() << " at " << places[i].transpose();
        touched += v != coming;
      }
      EXPECT_GT(touched, 40) << shape.index();
    }
  }
}

TEST(contact, of_a_turned_box_is_that_of_the_box_seen_from_its_frame) {
  Collider turned{.shape = Box{{-1, -1, -1}, {1, 1, 1}}, .friction = 0.3f};
  turned.pose.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitY())).coeffs();
  // Its edge is on top, at √2; a particle that comes down beside it meets the face there.
  const Vec3 v = resolve(turned, {0.4f, 0, 3}, {0, 0, -20});
  const Vec3 end = Vec3(0.4f, 0, 3) + 0.1f * v, normal = Vec3(1, 0, 1).normalized();
  EXPECT_NEAR(end.dot(normal), 1.5f, 1e-5f);
  EXPECT_EQ(resolve(turned, {0, 0, 3}, {0, 0, -10}), Vec3(0, 0, -10));  // 0.59 above the edge
}

/// A turntable: what sticks to it goes with it, on its circle, and keeps its gap.
TEST(contact, takes_what_sticks_along_as_the_collider_turns) {
  Collider table{.shape = Plane{{0, 0, 1}, 0}, .angular_velocity = {0, 0, 0.7f}, .friction = 1e6f};
  table.pose.translation = {1, 2, 0};
  Vec3 x(4, 2, 0.5f), v(0, 0, 0);
  for (int step = 0; step < 200; ++step) {
    v = resolve_one_row(table, k_step, x, v, v + Vec3(0, 0, -0.1f));
    x += 0.1f * v;
    move_colliders(0, 0.1, {&table, 1});
  }
  const double angle = static_cast<double>(0.7f) * 20;
  EXPECT_LT(
      (x.cast<double>() - Eigen::Vector3d(1 + 3 * std::cos(angle), 2 + 3 * std::sin(angle), 0.5)).norm(),
      1e-4);
}

/// However far it turns in a step: by normals of the start of the step it would end behind thin ones.
TEST(contact, holds_what_a_collider_sweeps_in_front_of_it) {
  for (const float turn : {0.01f, 0.3f, 0.6f, 0.9f, 1.2f}) {
    Collider blade{.shape = Box{{0, -0.02f, -20}, {40, 0.02f, 20}},
                   .angular_velocity = {0, 0, turn / k_step.time_step},
                   .friction = 0.4f};
    for (const float far : {1.0f, 9.0f, 20.0f}) {
      const Vec3 x(far, 1.5f, 0), v = resolve_one_row(blade, k_step, x, {0, 0, 0}, {0, 0, 0});
      const Vec3 end = x + k_step.time_step * v;
      const float in_front = end.y() * std::cos(turn) - end.x() * std::sin(turn);
      const float was = x.y() * std::cos(turn) - x.x() * std::sin(turn),
                  touches = 0.02f + k_step.contact_offset;
      EXPECT_NEAR(in_front, std::max(touches, was), 2e-5f * far) << turn << " rad, " << far;
    }
  }
}

/// A roller drives what lies on it with the speed of its surface, not with what it would have where the
/// particle is.
TEST(contact, slides_along_the_surface_of_what_turns) {
  Collider roller{.shape = Sphere{{0, 0, 0}, 2}, .angular_velocity = {0, 0.05f, 0}, .friction = 1e6f};
  EXPECT_NEAR(resolve(roller, {0, 0, 2.5f}, {0, 0, -1}).x(), 0.05f * 2, 1e-6f);
}

TEST(pose, after_a_turn_is_the_same_in_one_step_and_in_many) {
  Collider once{.velocity = {1, 2, 3}, .angular_velocity = {0.3f, -0.4f, 1.2f}}, often = once;
  move_colliders(0, 2, {&once, 1});
  for (int k = 0; k < 1000; ++k) move_colliders(0, 0.002, {&often, 1});
  EXPECT_LT((once.pose.translation - often.pose.translation).norm(), 1e-12);
  EXPECT_LT((once.pose.rotation - often.pose.rotation).norm(), 1e-12);
  EXPECT_NEAR(
      (rotation_of(once.pose) * Eigen::Vector3d(0.3f, -0.4f, 1.2f) - Eigen::Vector3d(0.3f, -0.4f, 1.2f))
          .norm(),
      0, 1e-12);
}

TEST(pose, moves_what_is_slower_than_single_precision_shows) {
  Collider slow{.velocity = {1e-4f, 0, 0}, .angular_velocity = {0, 0, 1e-5f}};
  slow.pose.translation = {1e5, 0, 0};
  for (int k = 0; k < 10000; ++k) move_colliders(0, 1e-2, {&slow, 1});
  EXPECT_NEAR(slow.pose.translation.x() - 1e5, 1e-2, 1e-7);
  EXPECT_NEAR(rotation_of(slow.pose)(1, 0), 1e-3, 1e-9);
}

TEST(pose, of_a_collider_takes_every_part_of_a_union_along) {
  Collider collider{.shape = Union{{Sphere{{1, 0, 0}, 1}, Box{{0, 0, 0}, {1, 1, 1}}, Plane{}}},
                    .velocity = {0, 0, 2}};
  move_colliders(0, 0.5, {&collider, 1});
  std::vector<PlacedCollider> placed;
  place_colliders({&collider, 1}, {0, 0, 0}, 0.1f, InstructionLevel::baseline, placed);
  ASSERT_EQ(placed[0].parts.size(), 3u);
  EXPECT_EQ(placed[0].parts[0].numbers.at[2], 1);  // centre
  EXPECT_EQ(placed[0].parts[1].numbers.at[5], 2);  // greatest corner
  EXPECT_EQ(placed[0].parts[2].numbers.at[3], 1);  // offset
  for (const Vec3& x : random_points(50, Vec3::Constant(-3), Vec3::Constant(3)))
    EXPECT_NEAR(nearest(collider, x).distance,
                nearest(std::get<Union>(collider.shape), x - Vec3(0, 0, 1)).distance, 1e-6f);
}

}  // namespace contact_test
}  // namespace mallow

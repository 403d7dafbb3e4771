#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "colliders/one_row.h"
#include "colliders/pose.h"
#include "mallow/errors.h"
#include "mallow/simulation.h"

namespace mallow {
namespace keyframes_test {

Pose turned(const Eigen::Vector3d& translation, double about_z) {
  return {translation, Eigen::Quaterniond(Eigen::AngleAxisd(about_z, Eigen::Vector3d::UnitZ())).coeffs()};
}

const std::vector<PoseKeyframe> k_path = {
    {1, turned({0, 0, 0}, 0)}, {3, turned({4, 0, 0}, 1.5)}, {4, turned({4, 1, 0}, 3)}};

TEST(keyframes, are_met_at_their_times_and_led_between_evenly) {
  for (const PoseKeyframe& key : k_path) {
    EXPECT_LT((pose_at(k_path, key.time).translation - key.pose.translation).norm(), 1e-15);
    EXPECT_LT((rotation_of(pose_at(k_path, key.time)) - rotation_of(key.pose)).norm(), 1e-14);
  }
  EXPECT_EQ(pose_at(k_path, -5).translation, k_path.front().pose.translation);
  EXPECT_EQ(pose_at(k_path, 99).rotation, k_path.back().pose.rotation);
  const Pose half = pose_at(k_path, 2);
  EXPECT_LT((half.translation - Eigen::Vector3d(2, 0, 0)).norm(), 1e-15);
  EXPECT_LT((rotation_of(half) - rotation_of(turned({0, 0, 0}, 0.75))).norm(), 1e-14);
}

TEST(keyframes, turn_the_shorter_way_round) {
  const std::vector<PoseKeyframe> path{{0, turned({0, 0, 0}, 3)}, {1, turned({0, 0, 0}, 3.5)}};
  std::vector<PoseKeyframe> other = path;
  other[1].pose.rotation = -other[1].pose.rotation;
  EXPECT_LT((rotation_of(pose_at(path, 0.5)) - rotation_of(turned({0, 0, 0}, 3.25))).norm(), 1e-14);
  EXPECT_LT((rotation_of(pose_at(other, 0.5)) - rotation_of(turned({0, 0, 0}, 3.25))).norm(), 1e-14);
}

/// One body on a table; the caller moves that.
struct OnTable {
  Simulation s{{.time_step = 0.1f, .support_radius = 2.1f, .contact_offset = 0.5f, .threads = 1}};
  ColliderId table;
  explicit OnTable(Collider collider) {
    collider.shape = Box{{-9, -9, -1}, {9, 9, 0}};
    collider.friction = 1e6f;
    table = s.add_collider(collider);
    s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {1, -1.5f, 0}, .jitter = 0}),
               Material{.alpha = 0});
  }
};

TEST(keyframes, take_what_sticks_along_and_then_hold_it) {
  const ContactStep step{.time_step = 0.125f,
                         .max_push = 2,
                         .contact_offset = 0.5f,
                         .gravity = {0, 0, -1},
                         .least_bounce = 0.3f};
  Collider table{.shape = Plane{}, .pose = k_path[0].pose, .friction = 1e6f, .keyframes = k_path};
  const Vec3 start(3, 1, 0.5f);
  Vec3 x = start, v(0, 0, 0);
  for (int k = 1; k <= 48; ++k) {
    const double end = 0.125 * k;
    drive_colliders(end, 0.125, {&table, 1});
    v = resolve_one_row(table, step, x, v, v + Vec3(0, 0, -0.125f));
    x += 0.125f * v;
    move_colliders(end, 0.125, {&table, 1});
    const Pose pose = pose_at(k_path, end);
    const Eigen::Vector3d expected = pose.translation + rotation_of(pose) * start.cast<double>();
    EXPECT_LT((x.cast<double>() - expected).norm(), 1e-4) << "at " << end;
    EXPECT_EQ(table.pose.translation, pose.translation);
  }
  EXPECT_EQ(table.velocity, Vec3(0, 0, 0));
  EXPECT_EQ(table.angular_velocity, Vec3(0, 0, 0));
}

TEST(keyframes, give_a_collider_of_a_simulation_its_velocities) {
  OnTable world({.keyframes = {{1, turned({0, 0, 0}, 0)}, {11, turned({2, 1, 0.5}, std::numbers::pi / 2)}}});
  for (int step = 0; step < 9; ++step) world.s.step();
  EXPECT_EQ(world.s.collider(world.table).velocity, Vec3(0, 0, 0));
  for (int step = 0; step < 3; ++step) world.s.step();
  EXPECT_LT((world.s.collider(world.table).velocity - Vec3(0.2f, 0.1f, 0.05f)).norm(), 1e-6f);
  EXPECT_NEAR(world.s.collider(world.table).angular_velocity.z(), std::numbers::pi / 20, 1e-6);
  while (world.s.time() < 12) world.s.step();
  EXPECT_EQ(world.s.collider(world.table).velocity, Vec3(0, 0, 0));
  EXPECT_EQ(world.s.collider(world.table).pose.translation, Eigen::Vector3d(2, 1, 0.5));
}

TEST(keyframes, go_on_with_the_same_bits_from_a_saved_state) {
  OnTable world(
      {.keyframes = {{0, turned({0, 0, 0}, 0)}, {5, turned({2, 1, 0.5}, 1)}, {8, turned({0, 0, 0}, -1)}}});
  for (int step = 0; step < 23; ++step) world.s.step();
  Simulation again = Simulation::restore(world.s.save(), 2);
  for (int step = 0; step < 80; ++step) {
    world.s.step();
    again.step();
  }
  EXPECT_EQ(again.state_hash(), world.s.state_hash());
  EXPECT_EQ(again.colliders()[0].pose.rotation, world.s.colliders()[0].pose.rotation);
}

TEST(set_pose, puts_a_collider_somewhere_at_once_or_moves_it_there) {
  OnTable world({.velocity = {0, 0, 0.1f}});
  world.s.step();
  world.s.set_pose(world.table, turned({0, 0, -3}, 0.5));
  EXPECT_EQ(world.s.collider(world.table).pose.translation, Eigen::Vector3d(0, 0, -3));
  EXPECT_EQ(world.s.collider(world.table).velocity, Vec3(0, 0, 0));
  world.s.set_pose(world.table, turned({0, 0, -2}, 0.5), 2);
  world.s.step();
  EXPECT_NEAR(world.s.collider(world.table).pose.translation.z(), -2.95, 1e-9);
  EXPECT_NEAR(world.s.collider(world.table).velocity.z(), 0.5f, 1e-6f);
  while (world.s.time() < 5) world.s.step();
  EXPECT_EQ(world.s.collider(world.table).pose.translation, Eigen::Vector3d(0, 0, -2));
  world.s.set_velocity(world.table, {1, 0, 0});
  EXPECT_TRUE(world.s.collider(world.table).keyframes.empty());
  world.s.step();
  EXPECT_NEAR(world.s.collider(world.table).pose.translation.x(), 0.1, 1e-8);
}

TEST(set_pose, refuses_what_is_no_pose_or_no_collider) {
  OnTable world({});
  EXPECT_THROW(world.s.set_pose(ColliderId{7}, {}), ConfigError);
  EXPECT_THROW(world.s.set_pose(world.table, {{std::nan(""), 0, 0}}), ConfigError);
  EXPECT_THROW(world.s.set_pose(world.table, {{0, 0, 0}, {0, 0, 0, 0}}), ConfigError);
  EXPECT_THROW(world.s.set_pose(world.table, {}, -1), ConfigError);
}

}  // namespace keyframes_test
}  // namespace mallow

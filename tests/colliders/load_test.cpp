// What particles do to a collider, as the simulation tells it.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "mallow/mallow.h"
#include "shapes/random_points.h"

namespace mallow {
namespace load_test {

Simulation falling(const Collider& collider, float alpha, int threads = 1, const Vec3& gravity = {0, 0, 0}) {
  Simulation s({.time_step = 0.15f, .support_radius = 2.1f, .gravity = gravity, .threads = threads});
  Body body = sample(Lattice{.count = {9, 9, 9}, .corner = {0, 0, 0.8f}});
  body.velocity = {0.5f, 0, -1.5f};
  s.add_body(body, {.alpha = alpha, .particle_mass = 0.7f});
  s.add_collider({.shape = Sphere{{50, 0, 0}, 1}});
  s.add_collider(collider);
  return s;
}

Eigen::Vector3d momentum(const Simulation& s, double mass) {
  Eigen::Vector3d sum(0, 0, 0);
  for (const Vec3& v : s.velocities_by_id()) sum += mass * v.cast<double>();
  return sum;
}
Eigen::Vector3d spin(const Simulation& s, double mass, const Eigen::Vector3d& about) {
  Eigen::Vector3d sum(0, 0, 0);
  const auto x = s.positions_by_id(), v = s.velocities_by_id();
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += mass * (x[i].cast<double>() - about).cross(v[i].cast<double>());
  return sum;
}

const double k_mass = static_cast<double>(0.7f);
const ColliderId k_id{1};

TEST(load, is_the_momentum_that_a_body_loses_to_a_plane) {
  Simulation s =
      falling({.shape = Plane{}, .restitution = 0.3f, .friction = 0.4f, .measure_load = true}, 0.5f);
  const Eigen::Vector3d start = momentum(s, k_mass);
  EXPECT_EQ(s.load(k_id).impulse, Eigen::Vector3d(0, 0, 0));
  Eigen::Vector3d given(0, 0, 0);
  for (int k = 0; k < 40; ++k) {
    s.step();
    given += s.load(k_id).impulse;
  }
  EXPECT_LT(given.z(), -1000);
  EXPECT_LT((start - momentum(s, k_mass) - given).norm(), 1e-5 * start.norm());
}

/// Nothing but the collider turns the body: of shape matching alone, pulls have no moment.
TEST(load, has_the_moment_that_turns_a_body_met_off_its_middle) {
  Collider ball{.shape = Sphere{{-2, -4, 0}, 2.5f}, .measure_load = true};
  ball.pose.translation = {4, 6, -2.5};
  Simulation s = falling(ball, 0);
  s.prepare();
  const Eigen::Vector3d about = ball.pose.translation, start = spin(s, k_mass, about);
  Eigen::Vector3d given(0, 0, 0);
  for (int k = 0; k < 30; ++k) {
    s.step();
    given += s.load(k_id).torque;
  }
  EXPECT_GT(given.norm(), 100);
  EXPECT_LT((start - spin(s, k_mass, about) - given).norm(), 1e-3 * given.norm());
}

/// One particle that strikes a ball along its z axis: J = m (v_n − v'_n), arm × J.
TEST(load, of_one_particle_is_its_change_of_momentum_and_the_moment_of_that) {
  Simulation s({.time_step = 0.1f, .support_radius = 2, .gravity = {0, 0, 0}, .contact_offset = 0.5f});
  Body body{.positions = {{3, 1, 0.6f}}, .velocity = {0, 0, -4}};
  s.add_body(body, {.alpha = 0, .particle_mass = 2});
  Collider floor{.shape = Plane{}, .measure_load = true};
  floor.pose.translation = {1, 0, 0};
  const ColliderId id = s.add_collider(floor);
  s.step();
  // It may come down by 0.1 in the step of 0.1 s: of 4 m/s, 1 is left.
  const ColliderLoad load = s.load(id);
  EXPECT_LT((load.impulse - Eigen::Vector3d(0, 0, -6)).norm(), 1e-5);
  EXPECT_LT((load.torque - Eigen::Vector3d(2, 1, 0.6).cross(load.impulse)).norm(), 1e-5);
}

TEST(load, has_the_same_bits_for_any_number_of_threads) {
  Collider ground{.shape = Box{{-20, -20, -3}, {20, 20, 0}},
                  .angular_velocity = {0, 0.01f, 0.1f},
                  .friction = 0.5f,
                  .measure_load = true};
  std::vector<ColliderLoad> first;
  for (const int threads : {1, 2, 3}) {
    Simulation s = falling(ground, 0.5f, threads, {0, 0, -0.3f});
    for (std::size_t k = 0; k < 20; ++k) {
      s.step();
      const ColliderLoad load = s.load(k_id);
      if (threads == 1) first.push_back(load);
      EXPECT_EQ(load.impulse, first[k].impulse) << k;
      EXPECT_EQ(load.torque, first[k].torque) << k;
    }
  }
  EXPECT_GT(first.back().torque.norm(), 0);
}

TEST(load, that_is_measured_changes_nothing) {
  Collider ground{.shape = Plane{}, .friction = 0.5f};
  Simulation without = falling(ground, 0.5f);
  ground.measure_load = true;
  Simulation with = falling(ground, 0.5f);
  for (int k = 0; k < 20; ++k) without.step(), with.step();
  EXPECT_EQ(with.state_hash(), without.state_hash());
}

TEST(load, is_refused_where_it_is_not_measured_or_there_is_no_collider) {
  Simulation s = falling({.shape = Plane{}, .measure_load = true}, 0.5f);
  EXPECT_NE(problem_of([&] { s.load(ColliderId{0}); }).find("collider.measure_load: is false"),
            std::string::npos);
  EXPECT_NE(problem_of([&] { s.load(ColliderId{2}); }).find("there is no collider 2"), std::string::npos);
  EXPECT_NE(problem_of([&] {
              s.set_twist(k_id, {0, 0, 0}, {std::nanf(""), 0, 0});
            }).find("angular_velocity"),
            std::string::npos);
}

TEST(turning_collider, goes_on_with_the_same_bits_from_a_saved_state) {
  Collider paddle{.shape = Box{{-1, -9, -9}, {1, 9, 9}},
                  .angular_velocity = {0, 0.2f, 0},
                  .friction = 0.5f,
                  .measure_load = true};
  paddle.pose = {{-3, 4, 2}, {0, 0.1, 0, 1}};
  Simulation s = falling(paddle, 0.5f);
  for (int k = 0; k < 15; ++k) s.step();
  Simulation again = Simulation::restore(s.save(), 2);
  double given = 0;
  for (int k = 0; k < 15; ++k) {
    s.step(), again.step();
    given += s.load(k_id).impulse.norm();
    EXPECT_EQ(again.load(k_id).torque, s.load(k_id).torque);
  }
  EXPECT_GT(given, 1);
  EXPECT_EQ(again.state_hash(), s.state_hash());
  EXPECT_EQ(again.collider(k_id).pose.rotation, s.collider(k_id).pose.rotation);
}

}  // namespace load_test
}  // namespace mallow

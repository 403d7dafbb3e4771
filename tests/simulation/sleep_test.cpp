#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/simulation.h"

namespace mallow {
namespace sleep_test {

SolverConfig solver(float gravity = 0.3f) {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -gravity}, .threads = 2};
}
Body cube(int n, const Eigen::Vector3d& corner) {
  return sample(Lattice{.count = {n, n, n}, .spacing = 1, .corner = corner.cast<float>(), .jitter = 0.02f});
}
/// A floor, and cubes of 5³ on it, far apart or in a column.
Simulation cubes(int count, bool column, SolverConfig config = solver()) {
  Simulation s(config);
  for (int k = 0; k < count; ++k)
    s.add_body(cube(5, column ? Eigen::Vector3d(0, 0, 5.1 * k) : Eigen::Vector3d(20.0 * k, 0, 0)),
               Material{});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  return s;
}
int steps_until_all_sleep(Simulation& s, int most = 4000) {
  for (int k = 1; k <= most; ++k) {
    s.step();
    const std::vector<BodyId> bodies = s.bodies();
    if (std::ranges::none_of(bodies, [&](BodyId body) { return s.is_awake(body); })) return k;
  }
  return most + 1;
}
bool happened(const Simulation& s, BodyEvent::Kind kind, BodyId body) {
  return std::ranges::any_of(
      s.events(), [&](const BodyEvent& event) { return event.kind == kind && event.body == body; });
}

TEST(sleep, of_cubes_at_rest_takes_every_phase_away_and_moves_nothing) {
  Simulation s = cubes(3, false);
  ASSERT_LT(steps_until_all_sleep(s), 4000);
  EXPECT_TRUE(happened(s, BodyEvent::Kind::slept, BodyId{2}));
  const std::vector<Vec3> before = s.positions_by_id();
  for (int k = 0; k < 500; ++k) {
    const StepReport report = s.step();
    EXPECT_EQ(report.awake_bodies, 0u);
    EXPECT_TRUE(s.events().empty());
  }
  EXPECT_EQ(s.positions_by_id(), before);
  for (const Vec3& v : s.velocities_by_id()) ASSERT_TRUE(v.isZero(0));
}

TEST(sleep, of_a_heap_leaves_its_weight_on_what_it_lies_on) {
  SolverConfig config = solver();
  Simulation s(config);
  std::vector<BodyId> bodies;
  for (int k = 0; k < 3; ++k) bodies.push_back(s.add_body(cube(5, {0, 0, 0.5 + 5.1 * k}), Material{}));
  const ColliderId floor = s.add_collider({.shape = Plane{}, .friction = 0.5f, .measure_load = true});
  const auto force = [&] {
    const double before = s.time();
    s.step();
    return Eigen::Vector3d(s.load(floor).impulse / (s.time() - before));
  };
  double weight = 0;
  for (const BodyId body : bodies) weight += s.motion(body).mass * static_cast<double>(config.gravity.norm());
  ASSERT_LT(steps_until_all_sleep(s), 4000);
  const Eigen::Vector3d asleep = force();
  EXPECT_NEAR(-asleep.z(), weight, 0.01 * weight);
  Simulation again = Simulation::restore(s.save());
  again.step();
  s.step();
  EXPECT_EQ(again.load(floor).impulse, s.load(floor).impulse);
  EXPECT_EQ(again.load(floor).torque, s.load(floor).torque);
  EXPECT_FALSE(s.is_awake(bodies[0]));
  // Awake it weighs as much; what is gone weighs nothing.
  for (const BodyId body : bodies) s.wake(body);
  EXPECT_NEAR(-force().z(), weight, 0.05 * weight);
  for (const BodyId body : bodies) s.remove_body(body);
  s.add_body(cube(5, {0, 0, 50}), Material{});
  EXPECT_EQ(force(), Eigen::Vector3d(0, 0, 0));
}

TEST(sleep, ends_for_a_whole_column_when_something_falls_on_it) {
  Simulation s = cubes(2, true);
  ASSERT_LT(steps_until_all_sleep(s), 4000);
  const BodyId ball = s.add_body(cube(3, {1, 1, 18}), Material{});
  int falling = 0;
  while (!s.is_awake(BodyId{1}) && falling < 1000) {
    EXPECT_FALSE(s.is_awake(BodyId{0}));
    s.step();
    ++falling;
  }
  ASSERT_LT(falling, 1000);
  EXPECT_GT(s.motion(ball).center_of_mass.z(), 9) << "it is only woken by what touches it";
  EXPECT_TRUE(happened(s, BodyEvent::Kind::woke, BodyId{0}));
  ASSERT_LT(steps_until_all_sleep(s), 4000) << "all sleep again";
}

TEST(sleep, loses_no_momentum_where_a_sleeper_is_met) {
  Simulation s(solver(0));
  s.add_body(cube(5, {0, 0, 0}), Material{});
  ASSERT_LT(steps_until_all_sleep(s), 100);
  Body bullet = cube(5, {-12, 0.3, 0.2});
  bullet.velocity = {1.5f, 0, 0};
  s.add_body(bullet, Material{});
  for (int k = 0; k < 200; ++k) s.step();
  EXPECT_TRUE(s.is_awake(BodyId{0}));
  const Eigen::Vector3d momentum = s.motion(BodyId{0}).momentum + s.motion(BodyId{1}).momentum;
  EXPECT_NEAR(momentum.x(), 125 * 1.5, 125 * 1.5 * 1e-5);
  EXPECT_GT(s.motion(BodyId{0}).velocity.x(), 0.4);
}

TEST(sleep, ends_where_its_ground_goes_or_moves_or_a_setting_changes) {
  const auto wakes = [](const auto& change) {
    Simulation s = cubes(2, true);
    const ColliderId shelf = s.add_collider({.shape = Box{{-50, -50, -2}, {50, 50, -1}}});
    EXPECT_LT(steps_until_all_sleep(s), 4000);
    change(s, shelf);
    s.step();
    return s.is_awake(BodyId{1});
  };
  EXPECT_FALSE(wakes([](Simulation&, ColliderId) {}));
  EXPECT_FALSE(wakes([](Simulation& s, ColliderId) {
    s.add_collider({.shape = Sphere{.center = {60, 0, 5}, .radius = 3}});
  })) << "it is far away";
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.remove_collider(ColliderId{0}); }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.set_velocity(ColliderId{0}, {0.5f, 0, 0}); }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.set_gravity({0.1f, 0, -0.3f}); }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.remove_body(BodyId{0}); })) << "what it lay on";
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.set_material(MaterialId{0}, {.damping_time = 0.1f}); }))
      << "of the one below it";
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.wake(BodyId{0}); }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) {
    s.add_collider({.shape = Sphere{.center = {2, 2, 13}, .radius = 3}});
  }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.add_impulse(BodyId{0}, {0, 0, 1}); }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) { s.pin(std::vector<ParticleId>{0}, {0, 0, 0.1f}); }));
  EXPECT_TRUE(wakes([](Simulation& s, ColliderId) {
    s.set_force([](const ForceInput&, VectorSpan a) { a.x()[3] = 0.1f; });
    s.step();
  }));
}

TEST(sleep, goes_on_where_others_are_told_to_do_something_far_away) {
  Simulation s = cubes(1, false);
  const ColliderId far = s.add_collider({.shape = Sphere{.center = {90, 0, 0}, .radius = 3}});
  ASSERT_LT(steps_until_all_sleep(s), 4000);
  const BodyId other = s.add_body(cube(3, {60, 0, 0}), Material{});
  const PinId pin = s.pin(Aabb{{59, -1, -1}, {64, 4, 0.7f}});
  for (int k = 0; k < 50; ++k) {
    s.set_twist(far, {0.01f * static_cast<float>(k), 0, 0}, {0, 0, 1});
    s.set_pose(far, {.translation = {5.0 + k, 9, 0}});
    s.set_velocity(pin, {0, 0.1f, 0});
    s.set_position(other, {60, static_cast<float>(k), 4});
    s.set_alpha(s.material(other), 0.01f * static_cast<float>(k));
    s.enable(other, k % 3 != 0);
    s.step();
    ASSERT_FALSE(s.is_awake(BodyId{0})) << k;
  }
  EXPECT_TRUE(s.is_awake(other));
}

TEST(sleep, does_not_come_to_what_a_pin_a_collider_or_a_force_moves) {
  const auto sleeps = [](const auto& drive) {
    Simulation s(solver(0));
    s.add_body(cube(4, {0, 0, 0}), Material{});
    drive(s);
    return steps_until_all_sleep(s, 400) <= 400;
  };
  EXPECT_TRUE(sleeps([](Simulation&) {}));
  EXPECT_FALSE(sleeps([](Simulation& s) { s.pin(std::vector<ParticleId>{0}, {1e-5f, 0, 0}); }));
  EXPECT_TRUE(sleeps([](Simulation& s) { s.pin(std::vector<ParticleId>{0}, {0, 0, 0}); }));
  EXPECT_FALSE(sleeps([](Simulation& s) {
    s.add_collider({.shape = Plane{.offset = -0.7f}, .angular_velocity = {0, 0, 1}});
  }));
  EXPECT_TRUE(sleeps([](Simulation& s) {
    s.add_collider({.shape = Sphere{.center = {60, 0, 0}, .radius = 9}, .velocity = {1, 0, 0}});
  })) << "it is far away";
  EXPECT_FALSE(
      sleeps([](Simulation& s) { s.set_force([](const ForceInput&, VectorSpan a) { a.x()[3] = 1e-4f; }); }));
}

TEST(sleep, of_some_changes_no_bit_of_what_an_elastic_body_does) {
  const auto path = [](float sleep_speed) {
    SolverConfig config = solver();
    config.sleep_speed = sleep_speed;
    Simulation s(config);
    s.add_body(cube(5, {0, 0, 0}), Material{});
    s.add_body(cube(4, {40, 0, 0}), Material{.alpha = 0.5f});
    Body jumper = cube(5, {80, 0, 30});
    s.add_body(jumper, Material{});
    s.add_collider({.shape = Plane{}, .restitution = 0.9f});
    std::size_t slept = 0;
    for (int k = 0; k < 1000; ++k) slept += s.step().awake_bodies < 3;
    const std::vector<Vec3> x = s.positions_by_id();
    return std::pair(std::vector<Vec3>(x.end() - 125, x.end()), slept);
  };
  const auto [with, slept] = path(0.03f);
  EXPECT_GT(slept, 100u);
  EXPECT_EQ(with, path(0).first);
}

TEST(sleep, of_some_changes_no_bit_of_what_flows_or_presses) {
  // Another body far away, on the side where the search would begin, sleeps or is kept awake.
  for (const bool pours : {false, true})
    for (const int iterations : {0, 2}) {
      SCOPED_TRACE(testing::Message() << (pours ? "a fluid" : "a jelly") << ", iterations " << iterations);
      const auto path = [&](bool sleeps) {
        SolverConfig config = solver();
        config.volume_iterations = iterations;
        Simulation s(config);
        Body awake = cube(7, {3.3, 2.1, 4});
        awake.velocity = {0.2f, 0.1f, 0};
        const Material material{.alpha = pours ? 1.0f : 0.4f, .viscosity = 0.3f};
        const BodyId flows = s.add_body(awake, material);
        const BodyId sleeper = s.add_body(cube(6, {-410.7, -230.1, 0}), Material{.alpha = 0.6f});
        s.add_collider({.shape = Plane{}, .friction = 0.3f});
        std::vector<std::vector<Vec3>> states;
        std::size_t slept = 0;
        for (int k = 0; k < 500; ++k) {
          s.wake(flows);
          if (!sleeps) s.wake(sleeper);
          if (sleeps && k == 350) s = Simulation::restore(s.save(), 1);
          slept += s.step().awake_bodies < 2;
          std::vector<Vec3> x = s.positions_by_id();
          x.resize(343);
          states.push_back(std::move(x));
        }
        return std::pair(std::move(states), slept);
      };
      const auto [with, slept] = path(true);
      EXPECT_GT(slept, 150u);
      const auto [without, never] = path(false);
      EXPECT_EQ(never, 0u);
      std::size_t alike = 0;
      while (alike < with.size() && with[alike] == without[alike]) ++alike;
      EXPECT_EQ(alike, with.size()) << "steps with the same bits";
    }
}

TEST(sleep, has_the_same_bits_on_any_number_of_threads_and_after_a_restore) {
  const auto run = [](int threads, bool restored) {
    SolverConfig config = solver();
    config.threads = threads;
    Simulation s = cubes(3, false, config);
    const std::size_t slow = 400;
    for (std::size_t k = 0; k < slow; ++k) s.step();
    if (restored) s = Simulation::restore(s.save(), threads);
    s.add_body(cube(4, {20, 0, 9}), Material{.alpha = 0.5f});
    std::vector<std::uint64_t> hashes;
    for (int k = 0; k < 120; ++k) {
      hashes.push_back(s.step().awake_bodies);
      hashes.push_back(s.state_hash());
    }
    return hashes;
  };
  const auto expected = run(1, false);
  EXPECT_EQ(run(3, false), expected);
  EXPECT_EQ(run(2, true), expected);
}

TEST(sleep, leaves_bodies_that_are_not_enabled_out_of_everything) {
  Simulation s(solver());
  const BodyId ghost = s.add_body(cube(5, {0, 0, 20}), Material{});
  const BodyId falls = s.add_body(cube(5, {0, 0, 40}), Material{});
  s.add_collider({.shape = Plane{}});
  s.enable(ghost, false);
  const Eigen::Vector3d at = s.motion(ghost).center_of_mass;
  while (s.motion(falls).center_of_mass.z() > 10) s.step();
  EXPECT_EQ(s.motion(ghost).center_of_mass, at) << "it was passed through and did not fall";
  s.enable(ghost, true);
  for (int k = 0; k < 20; ++k) s.step();
  EXPECT_LT(s.motion(ghost).center_of_mass.z(), at.z() - 0.5);
  s = Simulation::restore(s.save());
  EXPECT_TRUE(s.is_enabled(ghost));
}

// At the speed at which others sleep honey flows.
TEST(sleep, takes_nothing_that_still_creeps) {
  const auto lasts = [](const Material& material) {
    Simulation s(solver());
    const BodyId body = s.add_body(cube(5, {0, 0, 0}), material);
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    for (int k = 0; k < 1500; ++k) s.step();
    return s.is_awake(body);
  };
  EXPECT_TRUE(lasts({.alpha = 1.0f, .viscosity = 20}));
  EXPECT_FALSE(lasts({.alpha = 0.0f}));
}

// In steps far shorter than gravity asks for, a body that falls is slow for many of them.
TEST(sleep, takes_nothing_in_the_air_however_short_steps_are) {
  for (const float step : {0.15f, 0.03f, 0.01f})
    for (const float up : {0.0f, 0.5f}) {
      SolverConfig config = solver();
      config.time_step = step;
      Simulation s(config);
      Body body = cube(3, {0, 0, 50});
      body.velocity = {0, 0, up};
      const BodyId id = s.add_body(body, Material{});
      s.advance(6);
      EXPECT_NEAR(s.motion(id).velocity.z(), static_cast<double>(up) - 0.3 * 6, 1e-3) << step << ' ' << up;
    }
}

TEST(sleep, in_the_air_is_warned_of_where_settings_ask_for_it) {
  const auto says = [](float speed, float time) {
    SolverConfig config = solver();
    config.sleep_speed = speed;
    config.sleep_time = time;
    Simulation s(config);
    s.add_body(cube(3, {0, 0, 50}), Material{});
    s.prepare();
    return std::ranges::any_of(s.info().warnings, [](const std::string& text) {
      return text.find("falls asleep in the air") != std::string::npos;
    });
  };
  EXPECT_TRUE(says(0.5f, 1));
  EXPECT_FALSE(says(0.5f, 2));
  EXPECT_FALSE(says(0, 1));
}

}  // namespace sleep_test
}  // namespace mallow

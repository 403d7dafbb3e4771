#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "mallow/errors.h"
#include "mallow/simulation.h"

namespace mallow {
namespace events_test {

using Kind = BodyEvent::Kind;
constexpr float k_gravity = 0.3f;

SolverConfig solver(float gravity = k_gravity) {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -gravity}, .threads = 2};
}
Body cube(int n, const Vec3& corner, const Vec3& velocity = {0, 0, 0}) {
  Body body = sample(Lattice{.count = {n, n, n}, .corner = corner, .jitter = 0.02f});
  body.velocity = velocity;
  return body;
}
std::vector<BodyEvent> contacts(const Simulation& s, Kind kind) {
  std::vector<BodyEvent> found;
  std::ranges::copy_if(s.events(), std::back_inserter(found),
                       [&](const BodyEvent& event) { return event.kind == kind; });
  return found;
}
std::size_t count(const Simulation& s, Kind kind) {
  return contacts(s, kind).size();
}
std::string text(const Simulation& s) {
  std::ostringstream out;
  out.precision(9);
  for (const BodyEvent& event : s.events())
    out << s.step_count() << ": " << static_cast<int>(event.kind) << ' '
        << static_cast<std::uint64_t>(event.body) << ' ' << event.parts << ' '
        << static_cast<std::uint64_t>(event.other.value_or(BodyId{9999})) << ' '
        << static_cast<std::uint64_t>(event.collider.value_or(ColliderId{9999})) << ' '
        << event.position.transpose() << ' ' << event.normal.transpose() << ' ' << event.impulse.transpose()
        << ' ' << event.speed << '\n';
  return out.str();
}

TEST(contact_events, of_a_fall_on_the_floor_say_where_how_fast_and_with_all_of_its_momentum) {
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    SCOPED_TRACE(alpha);
    Simulation s(solver());
    const BodyId body = s.add_body(cube(6, {20, 0, 8}), Material{.alpha = alpha, .viscosity = 0.5f});
    const ColliderId floor = s.add_collider({.shape = Plane{}, .friction = 0.4f});
    s.report_contacts(0.0);
    int begun = 0;
    Eigen::Vector3d sum(0, 0, 0);
    for (int k = 0; k < 90; ++k) {
      s.step();
      for (const BodyEvent& event : contacts(s, Kind::touched)) {
        if (begun++ > 0) continue;
        EXPECT_EQ(event.body, body);
        EXPECT_EQ(event.collider, floor);
        EXPECT_FALSE(event.other);
        EXPECT_EQ(event.normal, Vec3(0, 0, 1));
        EXPECT_NEAR(event.position.z(), 0, 1e-6);
        EXPECT_NEAR(event.position.x(), 23, 0.3);
        EXPECT_NEAR(event.speed, std::sqrt(2 * k_gravity * 8), 1.5 * k_gravity * 0.15);
        EXPECT_GT(event.impulse.z(), 0.5 * 36 * event.speed * 0.1) << "the lowest layer begins to stop";
      }
      for (const BodyEvent& event : contacts(s, Kind::hit)) sum += event.impulse.cast<double>();
    }
    EXPECT_GE(begun, 1);
    const double weight = 216 * static_cast<double>(k_gravity);
    const Eigen::Vector3d balance = s.motion(body).momentum + Eigen::Vector3d(0, 0, weight * s.time());
    EXPECT_NEAR((sum - balance).norm(), 0, 1e-4 * balance.norm());
  }
}

TEST(contact_events, of_a_sheet_that_lands_stop_it_within_two_steps) {
  Simulation s(solver());
  s.add_body(sample(Lattice{.count = {6, 6, 1}, .corner = {0, 0, 8}, .jitter = 0}), Material{});
  s.add_collider({.shape = Plane{}});
  s.report_contacts(0.0);
  while (count(s, Kind::touched) == 0 && s.time() < 30) s.step();
  ASSERT_EQ(count(s, Kind::touched), 1u);
  double impulse = static_cast<double>(contacts(s, Kind::hit).front().impulse.z());
  const double speed = static_cast<double>(contacts(s, Kind::touched).front().speed);
  s.step();
  ASSERT_EQ(count(s, Kind::hit), 1u);
  impulse += static_cast<double>(contacts(s, Kind::hit).front().impulse.z());
  EXPECT_NEAR(impulse, 36 * speed, 0.05 * 36 * speed);
}

TEST(contact_events, of_what_rests_are_one_begin_and_no_end_awake_and_asleep) {
  for (const bool sleeps : {false, true})
    for (const float alpha : {0.0f, 0.3f, 0.7f, 1.0f}) {
      SCOPED_TRACE(testing::Message() << "sleeps " << sleeps << ", alpha " << alpha);
      SolverConfig config = solver();
      if (!sleeps) config.sleep_speed = 0;
      Simulation s(config);
      s.add_body(cube(5, {0, 0, 0}), Material{.alpha = alpha, .viscosity = 0.5f});
      s.add_collider({.shape = Plane{}, .friction = 0.5f});
      s.report_contacts();
      std::size_t begun = 0, ended = 0, hits = 0;
      while (s.time() < 120) {
        s.step();
        begun += count(s, Kind::touched);
        ended += count(s, Kind::parted);
        hits += count(s, Kind::hit);
      }
      EXPECT_EQ(s.is_awake(BodyId{0}), !sleeps);
      EXPECT_EQ(begun, 1u);
      EXPECT_EQ(ended, 0u);
      EXPECT_EQ(hits, 0u);
      s.wake(BodyId{0});
      for (int k = 0; k < 30; ++k) {
        s.step();
        EXPECT_EQ(count(s, Kind::touched) + count(s, Kind::parted), 0u) << "it has touched it all the time";
      }
    }
}

TEST(contact_events, of_a_ball_that_bounces_begin_and_end_in_turn_ever_more_slowly) {
  Simulation s(solver());
  s.add_body(sample(sphere_shape({0, 0, 14}, 3), {.spacing = 1.0f}), Material{});
  s.add_collider({.shape = Plane{}, .restitution = 0.9f});
  s.report_contacts();
  bool touches = false;
  std::vector<float> speeds;
  for (int k = 0; k < 400; ++k) {
    s.step();
    for (const BodyEvent& event : s.events()) {
      if (event.kind != Kind::touched && event.kind != Kind::parted) continue;
      EXPECT_EQ(event.kind == Kind::touched, !touches) << k;
      touches = !touches;
      if (touches) speeds.push_back(event.speed);
    }
  }
  ASSERT_GE(speeds.size(), 3u);
  EXPECT_NEAR(speeds[0], std::sqrt(2 * k_gravity * 10.5f), 0.1);
  for (std::size_t k = 1; k < 3; ++k) EXPECT_LT(speeds[k], speeds[k - 1]);
}

TEST(contact_events, of_two_bodies_have_the_momentum_that_goes_from_one_to_the_other) {
  for (const bool reused : {false, true}) {
    SCOPED_TRACE(reused);
    Simulation s(solver(0));
    const BodyId first = s.add_body(cube(5, {0, 0, 0}, {1, 0, 0}), Material{});
    BodyId second = s.add_body(cube(5, {8, 0, 0}), Material{});
    if (reused) {
      // The first of the rows has the greater id then.
      const BodyId gone = s.add_body(cube(2, {90, 0, 0}), Material{});
      s.remove_body(gone);
      const BodyId late = s.add_body(cube(5, {-8, 0, 0}, {2.5f, 0, 0}), Material{});
      EXPECT_GT(late, first);
      s.remove_body(second);
      second = late;
    }
    s.report_contacts(0.0);
    const Eigen::Vector3d before = s.motion(first).momentum;
    Eigen::Vector3d sum(0, 0, 0);
    std::size_t begun = 0, ended = 0;
    for (int k = 0; k < 120; ++k) {
      s.step();
      for (const BodyEvent& event : s.events()) {
        if (event.kind == Kind::slept || event.kind == Kind::woke) continue;
        EXPECT_EQ(event.body, first);
        EXPECT_EQ(event.other, second);
        EXPECT_FALSE(event.collider);
        if (event.kind == Kind::hit) sum += event.impulse.cast<double>();
        if (event.kind == Kind::touched && begun == 0) {
          EXPECT_NEAR(event.normal.x(), reused ? 1 : -1, 0.05);
          EXPECT_NEAR(event.speed, reused ? 1.5 : 1, 0.05);
          EXPECT_NEAR(event.position.y(), 2.5, 2.1) << "few touch in the first step";
          EXPECT_NEAR(event.position.x(), reused ? s.bounds(first).min.x() : s.bounds(first).max.x(), 0.8);
        }
      }
      begun += count(s, Kind::touched);
      ended += count(s, Kind::parted);
    }
    EXPECT_GE(begun, 1u);
    EXPECT_EQ(ended, begun) << "they flew apart";
    const Eigen::Vector3d change = s.motion(first).momentum - before;
    EXPECT_GT(std::abs(change.x()), 30);
    EXPECT_NEAR((sum - change).norm(), 0, 1e-4 * change.norm());
  }
}

// What load() says of the floor, and what the body's spin does, from two other sides.
TEST(contact_events, have_the_moment_that_goes_to_a_collider_and_into_the_spin_of_a_body) {
  Simulation s(solver());
  const BodyId body = s.add_body(cube(6, {20, 0, 6}), Material{.alpha = 0.2f});
  s.set_velocity(body, {0.7f, 0, 0}, {0.05f, 0.1f, 0});
  Collider slope{.shape = Plane{}, .friction = 0.4f, .measure_load = true};
  slope.pose = {.translation = {3, 2, 1}, .rotation = {0, 0.1, 0, 0.995}};
  const ColliderId floor = s.add_collider(slope);
  s.report_contacts(0.0);
  int hits = 0;
  for (int k = 0; k < 60; ++k) {
    s.step();
    for (const BodyEvent& event : contacts(s, Kind::hit)) {
      ++hits;
      const ColliderLoad load = s.load(floor);
      const Eigen::Vector3d impulse = event.impulse.cast<double>();
      const Eigen::Vector3d arm = event.position.cast<double>() - slope.pose.translation;
      const double size = impulse.norm() * arm.norm();
      EXPECT_LT((impulse + load.impulse).norm(), 1e-6 * impulse.norm());
      EXPECT_LT((event.torque.cast<double>() + arm.cross(impulse) + load.torque).norm(), 1e-6 * size);
    }
  }
  EXPECT_GT(hits, 5);
}

/// What a body's particles carry.
struct Carried {
  Eigen::Vector3d momentum{0, 0, 0}, spin{0, 0, 0};
};
Carried carried(const Simulation& s, BodyId body) {
  Carried sum;
  const Simulation::Rows rows = s.rows(body);
  const double mass = s.motion(body).mass / static_cast<double>(rows.end - rows.begin);
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    const Eigen::Vector3d v = mass * s.velocities()[row].cast<double>();
    sum.momentum += v;
    sum.spin += s.positions()[row].cast<double>().cross(v);
  }
  return sum;
}

TEST(contact_events, have_the_momentum_and_spin_that_each_of_two_bodies_gets_in_a_step) {
  for (const float alpha : {0.0f, 0.4f}) {
    SCOPED_TRACE(alpha);
    Simulation s(solver(0));
    const Material material{.alpha = alpha, .friction = 0.5f};
    const BodyId lower = s.add_body(cube(6, {0, 0, 0}), material);
    const BodyId upper = s.add_body(cube(4, {4, 1, 9}, {0.1f, 0, -0.5f}), material);
    s.report_contacts(0.0);
    Carried of_lower = carried(s, lower), of_upper = carried(s, upper);
    double most = 0, worst = 0, between = 0;
    for (int k = 0; k < 60; ++k) {
      s.step();
      Carried got, other_got;
      for (const BodyEvent& event : contacts(s, Kind::hit)) {
        const Eigen::Vector3d impulse = event.impulse.cast<double>();
        const Eigen::Vector3d moment = event.position.cast<double>().cross(impulse);
        got = {impulse, event.torque.cast<double>() + moment};
        other_got = {-impulse, event.other_torque.cast<double>() - moment};
        between = std::max(between, static_cast<double>((event.torque + event.other_torque).norm()));
      }
      for (const auto& [before, body, change] :
           {std::tuple(&of_lower, lower, got), std::tuple(&of_upper, upper, other_got)}) {
        const Carried now = carried(s, body);
        worst = std::max({worst, (now.momentum - before->momentum - change.momentum).norm(),
                          (now.spin - before->spin - change.spin).norm()});
        *before = now;
      }
      most = std::max(most, got.spin.norm());
    }
    EXPECT_GT(most, 1);
    EXPECT_GT(between, 0.01 * most) << "they rub a spacing apart";
    EXPECT_LT(worst, 3e-6 * most);
  }
}

TEST(contact_events, of_hits_are_those_above_the_impulse_that_is_asked_for) {
  const auto hits = [](double impulse) {
    Simulation s(solver());
    s.add_body(cube(5, {0, 0, 6}), Material{.alpha = 0.3f});
    s.add_body(cube(5, {0.4f, 0, 13}), Material{.alpha = 0.3f});
    s.add_collider({.shape = Plane{}, .restitution = 0.5f});
    s.report_contacts(impulse);
    std::vector<double> sizes;
    for (int k = 0; k < 150; ++k) {
      s.step();
      for (const BodyEvent& event : contacts(s, Kind::hit))
        sizes.push_back(event.impulse.cast<double>().norm());
    }
    return sizes;
  };
  std::vector<double> expected = hits(0);
  constexpr double k_least = 30;
  std::erase_if(expected, [&](double size) { return size < k_least; });
  EXPECT_GT(expected.size(), 3u);
  EXPECT_LT(expected.size(), hits(0).size() / 4);
  EXPECT_EQ(hits(k_least), expected);
}

TEST(contact_events, are_of_those_that_ask_and_of_all_that_come_where_all_do) {
  const auto who = [](const auto& ask) {
    Simulation s(solver());
    for (float x : {0.0f, 5.2f, 30.0f}) s.add_body(cube(5, {x, 0, 0.3f}), Material{});
    s.add_collider({.shape = Plane{}, .friction = 0});
    s.add_impulse(BodyId{1}, {-30, 0, 0});
    ask(s);
    s.add_body(cube(5, {60, 0, 0.3f}), Material{});
    std::ostringstream told;
    for (int k = 0; k < 30; ++k) {
      s.step();
      for (const BodyEvent& event : contacts(s, Kind::touched))
        told << static_cast<std::uint64_t>(event.body)
             << (event.other ? '0' + static_cast<char>(*event.other) : 'f') << ' ';
    }
    std::string words = told.str();
    return words;
  };
  EXPECT_EQ(who([](Simulation&) {}), "");
  EXPECT_EQ(who([](Simulation& s) { s.report_contacts(BodyId{2}); }), "2102 ");
}

TEST(contact_events, of_a_moving_collider_have_its_speed) {
  Simulation s(solver(0));
  s.add_body(cube(4, {0, 0, 2}), Material{});
  const ColliderId wall = s.add_collider({.shape = Plane{}, .velocity = {0, 0, 0.8f}});
  const ColliderId paddle =
      s.add_collider({.shape = Box{{-1, 1, -20}, {60, 3, 20}}, .pose = {.translation = {0, -50, 0}}});
  s.report_contacts();
  while (count(s, Kind::touched) == 0 && s.time() < 30) s.step();
  ASSERT_EQ(count(s, Kind::touched), 1u);
  EXPECT_EQ(contacts(s, Kind::touched).front().collider, wall);
  EXPECT_NEAR(contacts(s, Kind::touched).front().speed, 0.8, 1e-5);
  s.remove_collider(wall);
  for (int k = 0; k < 10; ++k) s.step();
  s.set_velocity(BodyId{0}, {0, 0, 0});
  s.set_position(BodyId{0}, {40, 0, 0});
  // It turns about x = 0, and meets the body 40 m from there.
  s.set_pose(paddle, {.translation = {0, -6.5, 0}});
  s.set_twist(paddle, {0, 0, 0}, {0, 0, 0.02f});
  while (count(s, Kind::touched) == 0 && s.time() < 60) s.step();
  ASSERT_EQ(count(s, Kind::touched), 1u);
  const BodyEvent met = contacts(s, Kind::touched).front();
  EXPECT_EQ(met.collider, paddle);
  EXPECT_NEAR(met.speed, 0.02 * 40, 0.05 * 0.8);
  EXPECT_NEAR(met.normal.y(), 1, 0.01);
}

TEST(contact_events, end_where_one_is_removed_or_not_enabled) {
  const auto ends = [](const auto& change) {
    Simulation s(solver());
    s.add_body(cube(5, {0, 0, 0}), Material{});
    s.add_body(cube(5, {0, 0, 5}), Material{});
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    s.report_contacts();
    for (int k = 0; k < 1000; ++k) s.step();
    EXPECT_FALSE(s.is_awake(BodyId{0}));
    change(s);
    s.step();
    std::string told;
    for (const BodyEvent& event : contacts(s, Kind::parted))
      told += std::to_string(slot_of(event.body)) +
              (event.other ? "+" + std::to_string(slot_of(*event.other)) : std::string("+floor")) + ' ';
    return told;
  };
  EXPECT_EQ(ends([](Simulation&) {}), "");
  EXPECT_EQ(ends([](Simulation& s) { s.remove_body(BodyId{0}); }), "0+floor 0+1 ");
  EXPECT_EQ(ends([](Simulation& s) { s.remove_body(BodyId{1}); }), "0+1 ");
  EXPECT_EQ(ends([](Simulation& s) { s.enable(BodyId{1}, false); }), "0+1 ");
  EXPECT_EQ(ends([](Simulation& s) { s.remove_collider(ColliderId{0}); }), "0+floor ");
  EXPECT_EQ(ends([](Simulation& s) {
              s.remove_body(BodyId{0});
              s.remove_body(BodyId{1});
            }),
            "0+floor 0+1 ");
  EXPECT_EQ(ends([](Simulation& s) {
              s.report_contacts(std::nullopt);
              s.remove_body(BodyId{0});
            }),
            "0+floor 0+1 ")
      << "of what is gone it is told where it was told of";
}

/// Cubes that fall on each other, a floor and a ball that moves.
Simulation heap(int threads) {
  SolverConfig config = solver();
  config.threads = threads;
  Simulation s(config);
  for (int k = 0; k < 6; ++k)
    s.add_body(
        cube(4, {3.0f * static_cast<float>(k % 2), static_cast<float>(k % 3), 5.0f * static_cast<float>(k)}),
        Material{.alpha = 0.2f * static_cast<float>(k % 3)});
  s.add_collider({.shape = Box{{-4, -4, 0}, {12, 12, 90}, true}, .friction = 0.3f});
  s.add_collider({.shape = Sphere{.center = {0, 0, 0}, .radius = 3}, .velocity = {0.05f, 0, 0}});
  return s;
}

TEST(contact_events, are_the_same_on_any_number_of_threads_and_after_a_restore) {
  const auto run = [](int threads, bool restored) {
    Simulation s = heap(threads);
    s.report_contacts(1.0);
    std::string told;
    for (int k = 0; k < 300; ++k) {
      if (restored && k % 50 == 20) {
        if (k == 20) s.wake(BodyId{1});
        s = Simulation::restore(s.save(), threads);
      }
      s.step();
      told += text(s);
    }
    return told;
  };
  const std::string expected = run(1, false);
  EXPECT_GT(std::ranges::count(expected, '\n'), 100);
  EXPECT_EQ(run(3, false), expected);
  EXPECT_EQ(run(2, true), expected);
}

TEST(contact_events, change_no_bit_of_a_motion) {
  Simulation told = heap(2), untold = heap(2);
  told.report_contacts(0.0);
  for (int k = 0; k < 200; ++k) {
    told.step();
    untold.step();
    ASSERT_EQ(told.state_hash(), untold.state_hash()) << k;
    ASSERT_EQ(count(untold, Kind::touched), 0u);
  }
}

TEST(contact_events, ascend_by_ids_with_colliders_first) {
  Simulation s = heap(2);
  s.report_contacts(0.0);
  for (int k = 0; k < 200; ++k) {
    s.step();
    std::vector<std::array<std::uint64_t, 3>> keys;
    for (const BodyEvent& event : contacts(s, Kind::hit)) {
      EXPECT_TRUE(!event.other || event.body < *event.other);
      keys.push_back({static_cast<std::uint64_t>(event.body), event.other.has_value(),
                      event.other ? static_cast<std::uint64_t>(*event.other)
                                  : static_cast<std::uint64_t>(*event.collider)});
    }
    EXPECT_TRUE(std::ranges::is_sorted(keys));
    EXPECT_EQ(std::ranges::adjacent_find(keys), keys.end()) << "one a pair";
  }
}

TEST(events, that_calls_left_are_told_once_by_the_step_that_succeeds) {
  Simulation s(solver());
  const BodyId body = s.add_body(cube(3, {0, 0, 1}), Material{});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  for (int k = 0; k < 2000 && s.is_awake(body); ++k) s.step();
  ASSERT_FALSE(s.is_awake(body));
  s.wake(body);
  s.set_force([](const ForceInput&, VectorSpan accelerations) {
    accelerations.x()[0] = std::numeric_limits<float>::quiet_NaN();
  });
  EXPECT_THROW(s.step(), StepError);
  EXPECT_TRUE(s.events().empty());
  s = Simulation::restore(s.save(), 1);
  s.step();
  ASSERT_EQ(count(s, Kind::woke), 1u);
  EXPECT_EQ(contacts(s, Kind::woke)[0].body, body);
  s.step();
  EXPECT_EQ(count(s, Kind::woke), 0u);
}

TEST(contact_events, refuse_what_is_out_of_range) {
  Simulation s(solver());
  s.add_body(cube(3, {0, 0, 0}), Material{});
  EXPECT_THROW(s.report_contacts(-1.0), ConfigError);
  EXPECT_THROW(s.report_contacts(std::numeric_limits<double>::quiet_NaN()), ConfigError);
  EXPECT_THROW(s.report_contacts(BodyId{0}, -1.0), ConfigError);
  EXPECT_THROW(s.report_contacts(BodyId{7}, 1.0), ConfigError);
  int refused = 0;
  s.set_force([&](const ForceInput&, VectorSpan) {
    try {
      s.report_contacts(1.0);
    } catch (const ConfigError&) {
      ++refused;
    }
  });
  s.step();
  EXPECT_EQ(refused, 1);
}

TEST(parts, of_a_body_that_is_pulled_apart_and_put_together_are_told) {
  for (const int stride : {1, 4}) {
    SCOPED_TRACE(stride);
    SolverConfig config = solver(1e-4f);  // enough to yield to
    config.update_interval = 20;
    Simulation s(config);
    const BodyId body = s.add_body(
        sample(Lattice{.count = {12, 4, 4}, .jitter = 0.02f}),
        Material{.alpha = 0.9f, .update_threshold = 0, .viscosity = 0.2f, .region_stride = stride});
    s.prepare();
    // Both halves fly apart and back, and a particle away.
    std::vector<ParticleId> left, right;
    for (std::size_t row = 0; row < s.particle_count(); ++row)
      (s.positions()[row].x() < 6 ? left : right).push_back(s.ids()[row]);
    const std::vector<ParticleId> crumb{left.back()};
    left.pop_back();
    const auto play = [&](float speed) {
      std::string told;
      for (int k = 0; k < 60 && told.empty(); ++k) {
        s.set_velocity(left, {-speed, 0, 0});
        s.set_velocity(right, {speed, 0, 0});
        s.set_velocity(crumb, {0, 0, 3});
        s.step();
        for (const BodyEvent& event : s.events()) {
          EXPECT_EQ(event.body, body);
          if (event.kind == Kind::torn) told += "torn " + std::to_string(event.parts);
          if (event.kind == Kind::merged) told += "merged " + std::to_string(event.parts);
        }
      }
      return told;
    };
    EXPECT_EQ(play(1), "torn 2");
    EXPECT_EQ(play(0.5f), "") << "they are apart, and only fly on";
    EXPECT_EQ(play(-1.5f), "merged 1");
  }
}

TEST(parts, of_a_body_that_yields_in_one_piece_are_not_told) {
  SolverConfig config = solver();
  config.update_interval = 5;
  Simulation s(config);
  s.add_body(cube(6, {0, 0, 0.5f}), Material{.alpha = 0.6f, .update_threshold = 0});
  s.add_collider({.shape = Plane{}});
  std::size_t yielded = 0;
  for (int k = 0; k < 200; ++k) {
    s.step();
    yielded += count(s, Kind::yielded);
    ASSERT_EQ(count(s, Kind::torn) + count(s, Kind::merged), 0u);
  }
  EXPECT_GT(yielded, 5u);
}

}  // namespace events_test
}  // namespace mallow

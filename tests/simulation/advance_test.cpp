#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mallow/mallow.h"

namespace mallow {
namespace advance_test {

Body cube(int side, const Vec3& corner = {0, 0, 0}, const Vec3& velocity = {0, 0, 0}) {
  Body body = sample(Lattice{{side, side, side}, 1.0f, corner});
  body.velocity = velocity;
  return body;
}

/// An elastic cube: no limit acts on its steps.
Simulation elastic(float time_step, const Vec3& velocity = {0, 0, 0}) {
  Simulation s({.time_step = time_step, .support_radius = 2, .gravity = {0, 0, 0}, .threads = 1});
  s.add_body(cube(4, {0, 0, 0}, velocity), Material{.alpha = 0});
  return s;
}

/// A paste that falls onto a floor; its steps are limited by the speed of sound.
Simulation limited(int threads = 1) {
  Simulation s({.time_step = 0.15f, .support_radius = 2, .threads = threads});
  s.add_body(cube(6, {0, 0, 0.6f}), Material{.alpha = 0.7f, .pressure_coefficient = 1600});
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  return s;
}

template <class Call>
std::string config_error(const Call& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(advance, lands_on_the_time_to_the_last_bit) {
  for (const double seconds : {1.0 / 24, 0.4, 0.15, 0.0333, 1.7, 1e-4}) {
    Simulation a = elastic(0.15f), b = limited();
    for (Simulation* s : {&a, &b}) {
      for (int frame = 1; frame <= 12; ++frame) {
        const double end = s->time() + seconds;
        s->advance(seconds);
        ASSERT_EQ(s->time(), end) << seconds;
      }
    }
  }
}

TEST(advance, takes_the_fewest_equal_steps) {
  Simulation s = elastic(0.15f);
  for (const auto& [seconds, steps] : {std::pair(0.4, 3), {0.16, 2}, {0.149, 1}, {0.01, 1}, {15.01, 101}}) {
    const AdvanceReport report = s.advance(seconds);
    EXPECT_EQ(report.steps, steps) << seconds;
    EXPECT_EQ(report.limited_steps, 0);
    EXPECT_NEAR(report.smallest_step, seconds / steps, 1e-6 * seconds / steps);
    EXPECT_NEAR(report.largest_step, seconds / steps, 1e-6 * seconds / steps);
  }
}

TEST(advance, a_whole_number_of_steps_costs_no_step_more_however_it_is_written) {
  for (const auto& [time_step, frame, steps] : {std::tuple(0.1f, 0.3, 3),
                                                {0.15f, 0.45, 3},
                                                {0.07f, 0.7, 10},
                                                {0.01f, 0.1, 10},
                                                {1.0f / 240, 1.0 / 24, 10},
                                                {0.15f, static_cast<double>(0.15f), 1},
                                                {0.15f, 0.15, 1}}) {
    Simulation s = elastic(time_step);
    for (int k = 1; k <= 300; ++k) {
      while (s.time() < k * frame) s.step_towards(k * frame);
      ASSERT_EQ(s.step_count(), k * steps) << time_step << " in frames of " << frame;
    }
  }
}

TEST(advance, over_whole_steps_gives_the_bits_of_single_steps) {
  Simulation advanced = elastic(0.15f, {0.3f, 0, 0.1f}), stepped = elastic(0.15f, {0.3f, 0, 0.1f});
  advanced.advance(20 * static_cast<double>(0.15f));
  for (int k = 0; k < 20; ++k) stepped.step();
  EXPECT_EQ(advanced.state_hash(), stepped.state_hash());
}

TEST(advance, leaves_no_sliver_where_limits_change) {
  Simulation s = limited();
  std::int64_t steps = 0, limited_steps = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const AdvanceReport report = s.advance(0.4);
    EXPECT_GT(report.smallest_step, 0.6 * report.largest_step) << "frame " << frame;
    EXPECT_LE(report.largest_step, 0.1500002);
    EXPECT_EQ(report.steps > 3, report.limited_steps > 0) << "frame " << frame;
    steps += report.steps;
    limited_steps += report.limited_steps;
  }
  EXPECT_GT(limited_steps, steps / 2) << "this scene's steps are limited";
  EXPECT_EQ(s.step_count(), steps);
}

TEST(advance, moves_by_the_time_it_is_given_however_short) {
  Simulation s = elastic(0.04f, {1, 0, 0});
  const std::vector<Vec3> start = s.positions_by_id();
  for (int frame = 1; frame <= 8; ++frame) {
    s.advance(0.01);
    EXPECT_NEAR(s.positions_by_id()[0].x() - start[0].x(), 0.01f * static_cast<float>(frame), 1e-6f);
  }
}

TEST(advance, a_time_far_below_a_step_is_no_error_of_a_limit) {
  for (const double seconds : {1e-5, 1e-9, 1e-40, 1e-300}) {
    Simulation s = limited();
    EXPECT_EQ(s.advance(seconds).steps, 1);
    EXPECT_EQ(s.time(), seconds);
  }
}

TEST(advance, stops_half_way_where_a_step_cannot_be_taken_and_keeps_what_was_done) {
  Simulation s = elastic(0.1f);
  s.set_force([](const ForceInput& in, VectorSpan a) {
    if (in.time > 0.25) a.x()[0] = std::numeric_limits<float>::quiet_NaN();
  });
  EXPECT_THROW(s.advance(1.0), StepError);
  EXPECT_EQ(s.step_count(), 3);
  EXPECT_NEAR(s.time(), 0.3, 1e-7);
}

TEST(advance, same_bits_for_any_thread_count) {
  Simulation one = limited(1), two = limited(2);
  for (Simulation* s : {&one, &two})
    for (int frame = 0; frame < 20; ++frame) s->advance(0.21);
  EXPECT_EQ(one.state_hash(), two.state_hash());
}

TEST(advance, by_nothing_does_nothing) {
  Simulation s = limited();
  EXPECT_EQ(s.advance(0).steps, 0);
  EXPECT_EQ(s.step_count(), 0);
}

TEST(advance, times_that_make_no_sense_are_refused) {
  Simulation s = limited();
  s.step();
  const double nan = std::numeric_limits<double>::quiet_NaN(), now = s.time();
  for (const double seconds : {-1.0, -1e-300, nan, std::numeric_limits<double>::infinity()})
    EXPECT_NE(config_error([&] { s.advance(seconds); }).find("seconds: "), std::string::npos) << seconds;
  EXPECT_NE(config_error([&] { s.advance(-1); }).find("-1 is not allowed: a finite number, 0 or above"),
            std::string::npos);
  for (const double end : {now, now - 1, nan})
    EXPECT_NE(config_error([&] { s.step_towards(end); }).find("end: "), std::string::npos) << end;
  EXPECT_EQ(s.time(), now);

  s.set_force([&](const ForceInput&, VectorSpan) { s.advance(1); });
  EXPECT_NE(config_error([&] { s.advance(1); }).find("callback"), std::string::npos);
  EXPECT_EQ(s.time(), now);
}

}  // namespace advance_test
}  // namespace mallow

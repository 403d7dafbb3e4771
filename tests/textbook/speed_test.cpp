// Holds the engine to being faster than the textbook, both on one thread, turn by turn in one process: a
// ratio survives a slow or busy machine, a time does not. Guards are a third of what was measured: they fail
// where a step takes three times as long, not where something else runs beside them.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "build_kind.h"
#include "levels.h"
#include "mallow/mallow.h"
#include "textbook/textbook.h"

namespace mallow {
namespace speed_test {

constexpr int k_repeats = 10;
/// Steps of a turn: about as long for the one as for the other.
constexpr int k_engine_steps = 16, k_textbook_steps = 2;

struct Case {
  float support_radius;
  Lattice lattice;
  Material material;
};

/// Seconds of a step, from a turn of `steps`.
template <class World>
double seconds_per_step(World& world, int steps) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  for (int k = 0; k < steps; ++k) world.step();
  return std::chrono::duration<double>(Clock::now() - start).count() / steps;
}

/// How many times as long the textbook takes for a step. The fastest turn of each counts: the others were
/// interrupted.
[[maybe_unused]] double times_as_fast(const Case& c, InstructionLevel level) {
  const SolverConfig config{
      .support_radius = c.support_radius, .acoustic_limit = false, .threads = 1, .instruction_level = level};
  // Stirred: at rest, regions would need no rotations and lists would not change.
  Body body = sample(c.lattice);
  for (const Vec3& x : body.positions)
    body.velocities.push_back(0.2f * Vec3(std::sin(x.y() / 3), std::sin(x.z() / 3), std::sin(x.x() / 3)));
  const Collider floor{.shape = Plane{}, .friction = 0.3f};
  Simulation engine(config);
  engine.add_body(body, c.material);
  engine.add_collider(floor);
  textbook::Textbook textbook(config);
  textbook.add_body(body, textbook.add_group(c.material));
  textbook.add_collider(floor);

  engine.step();
  textbook.step();
  double engine_seconds = HUGE_VAL, textbook_seconds = HUGE_VAL;
  for (int repeat = 0; repeat < k_repeats; ++repeat) {
    engine_seconds = std::min(engine_seconds, seconds_per_step(engine, k_engine_steps));
    textbook_seconds = std::min(textbook_seconds, seconds_per_step(textbook, k_textbook_steps));
  }
  std::printf("%s: engine %.3f ms, textbook %.3f ms a step, ratio %.1f\n", name(level), 1e3 * engine_seconds,
              1e3 * textbook_seconds, textbook_seconds / engine_seconds);
  return textbook_seconds / engine_seconds;
}

/// Ratios that were measured on an AMD EPYC of level x86-64-v3, g++ 12.2.
struct Measured {
  double baseline, v3;
};

void hold([[maybe_unused]] const Case& c, [[maybe_unused]] const Measured& measured) {
#ifdef MALLOW_TIMED
  for (const InstructionLevel level : levels())
    EXPECT_GT(times_as_fast(c, level),
              (level == InstructionLevel::baseline ? measured.baseline : measured.v3) / 3)
        << name(level);
#else
  GTEST_SKIP() << "speed is measured in optimised builds without sanitizers only: nothing was checked";
#endif
}

// Table 1's bar of region radius 3: 64.3 neighbours, no SPH.
TEST(speed, of_an_elastic_bar_is_more_than_a_third_of_what_was_measured) {
  hold({.support_radius = 3.0f,
        .lattice = {.count = {36, 10, 10}, .spacing = 1.1111111f, .corner = {0, 0, 20}},
        .material = {.alpha = 0}},
       {.baseline = 18.6, .v3 = 25.6});
}

// Table 1's cube: SPH and shape matching, 23.6 neighbours.
TEST(speed, of_a_cube_of_paste_is_more_than_a_third_of_what_was_measured) {
  hold({.support_radius = 2.9f,
        .lattice = {.count = {15, 15, 15}, .spacing = 1.4666667f, .corner = {0, 0, 10}},
        .material = {.alpha = 0.7f, .update_threshold = 12}},
       {.baseline = 2.7, .v3 = 11.8});
}

}  // namespace speed_test
}  // namespace mallow

#include <gtest/gtest.h>

#include <algorithm>

#include "levels.h"
#include "mallow/mallow.h"

namespace mallow {
namespace native_test {

/// What a scene takes its sums by.
struct Sums {
  Arithmetic arithmetic = Arithmetic::native;
  InstructionLevel level = best_instruction_level();
  int threads = 2;
};

/// Two viscous bodies whose volume is kept, and a third that merges with one of them, fall on a slope.
Simulation falling(const Sums& sums, Formulation formulation = Formulation::conservative) {
  Simulation s({.support_radius = 2.1f,
                .update_interval = 8,
                .formulation = formulation,
                .volume_iterations = 2,
                .arithmetic = sums.arithmetic,
                .threads = sums.threads,
                .instruction_level = sums.level});
  const auto cube = [](const Vec3& corner, bool merges = false) {
    Body body = sample(Lattice{.count = {7, 6, 5}, .spacing = 1, .corner = corner, .jitter = 0.1f});
    body.merges = merges;
    return body;
  };
  const MaterialId paste = s.add_material({.alpha = 0.6f, .update_threshold = 0.1f, .viscosity = 0.7f});
  s.add_body(cube({0, 0, 0.2f}, true), paste);
  s.add_body(cube({0, 6, 0.2f}, true), paste);
  s.add_body(cube({2, 2, 6}), Material{.alpha = 1, .viscosity = 0.2f});
  s.add_collider({.shape = Plane{{0.1f, 0, 1}, 0}, .friction = 0.3f});
  return s;
}

std::uint64_t hash_after_20_steps(Simulation s) {
  for (int k = 0; k < 20; ++k) s.step();
  return s.state_hash();
}

TEST(native, has_the_same_bits_for_any_number_of_threads) {
  for (const Formulation formulation : {Formulation::conservative, Formulation::printed})
    for (const InstructionLevel level : levels()) {
      const std::uint64_t one = hash_after_20_steps(falling({.level = level, .threads = 1}, formulation));
      for (const int threads : {2, 3})
        EXPECT_EQ(hash_after_20_steps(falling({.level = level, .threads = threads}, formulation)), one)
            << name(level) << ", " << threads << " threads";
    }
}

TEST(native, is_exact_at_the_lowest_level_alone) {
  const std::uint64_t exact = hash_after_20_steps(falling({.arithmetic = Arithmetic::exact}));
  for (const InstructionLevel level : levels())
    EXPECT_EQ(hash_after_20_steps(falling({.level = level})) == exact, level == InstructionLevel::baseline)
        << name(level);
}

TEST(native, goes_on_with_the_same_bits_where_it_was_saved) {
  Simulation s = falling({});
  for (int step = 0; step < 10; ++step) s.step();
  Simulation again = Simulation::restore(s.save(), 3);
  EXPECT_EQ(again.config().arithmetic, Arithmetic::native);
  for (int step = 0; step < 10; ++step) {
    s.step();
    again.step();
    ASSERT_EQ(again.state_hash(), s.state_hash()) << step;
  }
}

/// Where particles are after a cube has settled under its own weight, or has run out [h].
std::vector<Vec3> settled(float alpha, int volume_iterations, int steps, const Sums& sums) {
  Simulation s({.support_radius = 2.1f,
                .volume_iterations = volume_iterations,
                .arithmetic = sums.arithmetic,
                .threads = sums.threads,
                .instruction_level = sums.level});
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .spacing = 1}), Material{.alpha = alpha, .viscosity = 0.5f});
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  for (int step = 0; step < steps; ++step) s.step();
  return s.positions_by_id();
}

float farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  float result = 0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, (a[i] - b[i]).norm());
  return result;
}

/// How far native sums take the farthest particle from where exact ones do [h].
float largest_difference(float alpha, int volume_iterations, int steps, InstructionLevel level) {
  const auto exact = settled(alpha, volume_iterations, steps, {.arithmetic = Arithmetic::exact});
  const auto native = settled(alpha, volume_iterations, steps, {.level = level});
  float largest = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) largest = std::max(largest, (native[i] - exact[i]).norm());
  return largest;
}

// 6e-6 with AVX-512, 3e-5 with AVX2.
TEST(native, settles_where_exact_sums_do) {
  for (const float alpha : {0.3f, 0.7f})
    for (const int iterations : {0, 2})
      for (const InstructionLevel level : levels())
        EXPECT_LT(largest_difference(alpha, iterations, 240, level), 5e-5f)
            << alpha << ' ' << iterations << ' ' << name(level);
}

// A lattice that runs out is unstable: what differs grows. 0.001 with AVX-512, 0.004 with AVX2.
TEST(native, runs_out_as_exact_sums_do) {
  for (const int iterations : {0, 2})
    for (const InstructionLevel level : levels())
      EXPECT_LT(largest_difference(1, iterations, 60, level), 0.01f) << iterations << ' ' << name(level);
}

}  // namespace native_test
}  // namespace mallow

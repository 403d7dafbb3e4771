#include <gtest/gtest.h>

#include "config/validation.h"
#include "levels.h"
#include "mallow/mallow.h"

namespace mallow {
namespace instruction_level_test {

/// Two groups that touch, half elastic, viscous, on a floor: a step takes all of its lanes.
Simulation scene(Formulation formulation, int threads, std::optional<InstructionLevel> level) {
  Simulation s({.support_radius = 2.1f,
                .update_interval = 8,
                .formulation = formulation,
                .threads = threads,
                .instruction_level = level});
  const auto cube = [](const Vec3& corner) {
    return sample(Lattice{.count = {9, 8, 7}, .corner = corner, .jitter = 0.1f});
  };
  s.add_body(cube({0, 0, 0.2f}), Material{.alpha = 0.6f, .update_threshold = 0.1f, .viscosity = 0.7f});
  s.add_body(cube({2, 2, 8}), Material{.alpha = 0.3f, .viscosity = 0.2f, .region_stride = 2});
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  return s;
}

std::uint64_t hash_after_20_steps(Simulation s) {
  for (int k = 0; k < 20; ++k) s.step();
  return s.state_hash();
}

TEST(instruction_level, of_every_kind_gives_the_same_bits_for_any_thread_count) {
  for (const Formulation formulation : {Formulation::conservative, Formulation::printed}) {
    const std::uint64_t best = hash_after_20_steps(scene(formulation, 1, std::nullopt));
    for (const InstructionLevel level : levels())
      for (const int threads : {1, 2, 3})
        EXPECT_EQ(hash_after_20_steps(scene(formulation, threads, level)), best)
            << name(level) << ", " << threads << " threads, formulation " << static_cast<int>(formulation);
  }
}

TEST(instruction_level, that_is_given_is_the_one_that_runs_and_the_best_where_none_is) {
  for (const InstructionLevel level : levels())
    EXPECT_EQ(scene(Formulation::conservative, 1, level).info().instruction_level, level);
  EXPECT_EQ(scene(Formulation::conservative, 1, std::nullopt).info().instruction_level,
            best_instruction_level());
}

std::string problem(InstructionLevel level, InstructionLevel best) {
  Checks checks;
  check(level, best, checks);
  try {
    checks.finish();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(instruction_level, that_the_machine_lacks_is_refused_with_those_it_has) {
  const std::string lowest = name(InstructionLevel::baseline);
  EXPECT_EQ(problem(InstructionLevel::v4, InstructionLevel::v3),
            "solver.instruction_level: x86-64-v4 is not allowed: this machine has " + lowest + ", x86-64-v3");
  EXPECT_EQ(problem(InstructionLevel::v3, InstructionLevel::baseline),
            "solver.instruction_level: x86-64-v3 is not allowed: this machine has " + lowest);
  for (const InstructionLevel best : k_instruction_levels)
    EXPECT_EQ(problem(InstructionLevel::baseline, best), "");
  // At the border of the library, with one that no machine has.
  EXPECT_THROW(scene(Formulation::conservative, 1, InstructionLevel{7}), ConfigError);
  for (const InstructionLevel level : k_instruction_levels)
    if (level > best_instruction_level()) {
      EXPECT_THROW(scene(Formulation::conservative, 1, level), ConfigError) << name(level);
    }
}

}  // namespace instruction_level_test
}  // namespace mallow

#include <gtest/gtest.h>

#include <ostream>

#include "levels.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow {
namespace golden_test {

/// State hashes after 60 steps. They hold for any thread count, instruction level and build type, and change
/// where arithmetic does: then the new ones are set in a commit of their own that says why.
struct Golden {
  const char* scene;
  std::uint64_t hash;
  friend void PrintTo(const Golden& golden, std::ostream* out) { *out << golden.scene; }
};
constexpr Golden k_golden[] = {
    {"table1/bar_sigma3", 18093152534065734076u},  // regions of 64, pinned at one end
    {"table1/cube_3375", 15061345285892117121u},   // alpha 0.7, falls onto the floor
    {"table1/moai_2015", 18354959809899220495u},   // alpha 0, an implicit shape
    {"table1/balls_8264", 7137290262937935123u},   // alpha 0.9, spheres and a pool, updates
    {"fig3_alpha_10", 899480510197429419u},      // a fluid
};

class golden : public testing::TestWithParam<Golden> {};

std::uint64_t hash_of(const Golden& golden, int threads, InstructionLevel level) {
  Scene scene =
      read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes" / (std::string(golden.scene) + ".toml"));
  scene.solver.instruction_level = level;
  Simulation simulation = build(scene, threads);
  for (int step = 0; step < 60; ++step) simulation.step();
  return simulation.state_hash();
}

TEST_P(golden, state_is_that_of_every_thread_count_and_instruction_level) {
  for (const int threads : {1, 2, 3, 4, 7, 8})
    EXPECT_EQ(hash_of(GetParam(), threads, best_instruction_level()), GetParam().hash)
        << threads << " threads";
  for (const InstructionLevel level : levels())
    EXPECT_EQ(hash_of(GetParam(), 2, level), GetParam().hash) << name(level);
}

INSTANTIATE_TEST_SUITE_P(scenes, golden, testing::ValuesIn(k_golden));

}  // namespace golden_test
}  // namespace mallow

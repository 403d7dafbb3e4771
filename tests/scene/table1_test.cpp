#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>

#include "mallow/scene.h"

namespace mallow {
namespace table1_test {

/// A row of [TK] Table 1: what the paper prints.
struct Row {
  const char* scene;
  double particles, neighbors;
  float alpha, update_threshold;
  int voxels;
  bool exact;  ///< the scene is decoded to the digit
  friend void PrintTo(const Row& row, std::ostream* out) { *out << row.scene; }
};

class Table1 : public testing::TestWithParam<Row> {};

TEST_P(Table1, has_the_particles_and_average_neighbors_of_the_paper) {
  const Row& row = GetParam();
  const Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/table1" /
                                 (std::string(row.scene) + ".toml"));
  const SimulationInfo info = build(scene).info();
  ASSERT_EQ(info.bodies.size(), 1u);
  EXPECT_NEAR(static_cast<double>(info.particles), row.particles, row.exact ? 0 : 0.01 * row.particles);
  EXPECT_NEAR(info.bodies[0].average_neighbors, row.neighbors, row.exact ? 0.1 : 0.02 * row.neighbors);
  const Material& material = scene.materials[0].material;
  EXPECT_EQ(material.alpha.lowest(), row.alpha);
  EXPECT_EQ(material.update_threshold, row.update_threshold);
  EXPECT_EQ(scene.surface.voxels, row.voxels);
  EXPECT_FALSE(scene.solver.acoustic_limit);
  EXPECT_FALSE(scene.solver.wall_pressure);
  EXPECT_EQ(scene.solver.time_step, 0.15f);
}

INSTANTIATE_TEST_SUITE_P(rows, Table1,
                         testing::Values(Row{"bar_sigma8", 3600, 755.3, 0, 8, 128, true},
                                         Row{"bar_sigma5", 3600, 256.5, 0, 8, 128, true},
                                         Row{"bar_sigma3", 3600, 64.3, 0, 8, 128, true},
                                         Row{"cube_10648", 10648, 80.7, 0.7f, 12, 128, true},
                                         Row{"cube_3375", 3375, 23.6, 0.7f, 12, 128, true},
                                         Row{"moai_3764", 3764, 85.3, 0, 6, 192, false},
                                         Row{"moai_2015", 2015, 43.1, 0, 6, 96, false},
                                         Row{"armadillo_4157", 4157, 27.1, 0.8f, 6, 192, false},
                                         Row{"armadillo_2680", 2680, 16.6, 0.8f, 6, 96, false},
                                         Row{"bunny_4185", 4185, 35.1, 0.85f, 6, 192, false},
                                         Row{"bunny_1328", 1328, 26.7, 0.85f, 6, 48, false},
                                         Row{"balls_8264", 8264, 28.3, 0.9f, 10, 224, false}),
                         [](const auto& row) { return std::string(row.param.scene); });

}  // namespace table1_test
}  // namespace mallow

// What flows in the regions of shape matching: model 2, section 5.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "levels.h"
#include "matrix_regions.h"

namespace mallow {
namespace flow_test {

constexpr std::size_t k_regions = 61;  // no whole number of lanes

/// Of regions side by side some have flowed, some flow now, and most are as they were. A quarter of all is at
/// rest, with zeros of both signs.
struct Region {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
  CarriedStretch stretch;
};

Region region(std::size_t j) {
  std::mt19937 random(static_cast<unsigned>(j));
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto zero = [&] { return uniform(random) > 0 ? 0.0 : -0.0; };
  Region made;
  if (j % 16 == 7) made.stretch = {.stretch = Eigen::Vector3f(1.1f, 0.9f, 1.0f).asDiagonal(), .flow = 0.1f};
  if (j % 4 == 0) {
    made.last = Eigen::Quaterniond(j % 8 == 0 ? 1 : -1, zero(), zero(), zero());
    return made;
  }
  const double most = j % 5 == 0 ? 0.3 : 0.02;
  made.matrix += most * Eigen::Matrix3d::NullaryExpr([&](Eigen::Index) { return uniform(random); });
  return made;
}

constexpr FlowRule k_rule{.yield = 0.05f, .creep = 2};

TEST(flow, does_not_depend_on_the_regions_beside_it_nor_on_the_instruction_level) {
  const auto solved = [](std::size_t first, std::size_t count, InstructionLevel level) {
    MatrixRegions regions(count, true);
    for (std::size_t k = 0; k < count; ++k) {
      const Region one = region(first + k);
      regions.set(k, one.matrix, one.last);
      set_stretch(one.stretch, k, regions.shape.plastic);
    }
    regions.solve(level, k_rule, 0.1f);
    return regions;
  };
  const MatrixRegions reference = solved(0, k_regions, InstructionLevel::baseline);
  std::size_t flowed = 0;
  for (std::size_t j = 0; j < k_regions; ++j)
    flowed += reference.shape.plastic.flow[j] > region(j).stretch.flow;
  EXPECT_GE(flowed, 5u);
  EXPECT_LE(flowed, k_regions / 3);
  for (const InstructionLevel level : levels()) {
    const MatrixRegions together = solved(0, k_regions, level);
    for (std::size_t j = 0; j < k_regions; ++j) {
      EXPECT_EQ(together.row(j), reference.row(j)) << name(level) << ", region " << j;
      EXPECT_EQ(solved(j, 1, level).row(0), reference.row(j)) << name(level) << ", region " << j << " alone";
    }
  }
}

}  // namespace flow_test
}  // namespace mallow

#include "program/end_warnings.h"

#include <gtest/gtest.h>

namespace mallow::program {
namespace end_warnings_test {

TEST(crushed_share, counts_who_has_a_neighbour_within_three_tenths_of_a_spacing) {
  std::vector<Vec3> positions =
      sample(Lattice{.count = {9, 8, 7}, .spacing = 0.5f, .corner = {-2, 3, 1e3f}}).positions;
  EXPECT_EQ(crushed_share(positions, 0.5f), 0);
  const std::size_t apart = positions.size();
  // Across cells and along each axis, just within and just beyond.
  for (int axis = 0; axis < 3; ++axis)
    for (const float distance : {0.14f, -0.14f, 0.16f}) {
      const Vec3 base(static_cast<float>(20 * axis), 100 * distance, -9.0f);
      positions.push_back(base);
      positions.push_back(base + distance * Vec3::Unit(axis));
    }
  EXPECT_DOUBLE_EQ(crushed_share(positions, 0.5f), 12.0 / static_cast<double>(apart + 18));
  EXPECT_EQ(crushed_share({}, 1), 0);
}

}  // namespace end_warnings_test
}  // namespace mallow::program

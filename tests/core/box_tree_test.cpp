#include "core/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace mallow {
namespace box_tree_test {

std::vector<Aabb> some_boxes(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-10, 10), size(0, 1);
  std::vector<Aabb> boxes;
  for (std::size_t b = 0; b < count; ++b) {
    const Vec3 corner(place(random), place(random), place(random));
    const float scale = b % 50 == 0 ? 30.0f : 1.0f;  // large ones among small ones
    boxes.push_back({corner, corner + scale * Vec3(size(random), size(random), size(random))});
  }
  return boxes;
}

TEST(box_tree, finds_what_overlaps_and_nothing_else) {
  for (const std::size_t count : {0u, 1u, 8u, 9u, 64u, 65u, 700u}) {
    std::vector<Aabb> boxes = some_boxes(count, 1);
    if (count > 10) boxes[7] = empty_box();
    if (count > 10) boxes[9].max[1] = HUGE_VALF;
    BoxTree tree;
    for (int turn = 0; turn < 2; ++turn) {  // the second in memory that there is
      tree.build(boxes);
      for (const Aabb& box : some_boxes(100, 2)) {
        std::vector<std::uint32_t> found, expected;
        tree.for_overlapping(box, [&](std::uint32_t b) { found.push_back(b); });
        for (std::uint32_t b = 0; b < boxes.size(); ++b)
          if (are_near(boxes[b], box, 0)) expected.push_back(b);
        std::ranges::sort(found);
        EXPECT_EQ(found, expected);
      }
      std::ranges::reverse(boxes);
    }
  }
}

}  // namespace box_tree_test
}  // namespace mallow

#include "surface/block_map.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

namespace mallow {
namespace block_map_test {

using Key = std::tuple<int, int, int>;

/// Boxes here and there, on both sides of zero, some of which overlap.
BlockMap some_blocks() {
  BlockMap map;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(-9, 9), size(0, 4);
  for (int box = 0; box < 25; ++box) {
    const BlockMap::Coord first(place(random), place(random), place(random));
    map.insert(first, first + BlockMap::Coord(size(random), size(random), size(random)));
  }
  map.number();
  return map;
}

std::map<Key, std::uint32_t> numbers_of(const BlockMap& map) {
  std::map<Key, std::uint32_t> numbers;
  for (std::uint32_t b = 0; b < map.blocks().size(); ++b) {
    const BlockMap::Coord& at = map.blocks()[b];
    numbers[{at.x(), at.y(), at.z()}] = b;
  }
  return numbers;
}

TEST(block_map, neighbors_are_the_blocks_one_away_along_each_axis) {
  const BlockMap map = some_blocks();
  const std::map<Key, std::uint32_t> numbers = numbers_of(map);
  ASSERT_EQ(numbers.size(), map.size());
  std::vector<std::array<std::uint32_t, 27>> around(map.size());
  for (std::size_t c = 0; c < map.cubes(); ++c) map.find_around(c, around);
  for (std::size_t b = 0; b < around.size(); ++b) {
    for (int slot = 0; slot < 27; ++slot) {
      const BlockMap::Coord at =
          map.blocks()[b] + BlockMap::Coord(slot / 9 - 1, slot / 3 % 3 - 1, slot % 3 - 1);
      const auto found = numbers.find({at.x(), at.y(), at.z()});
      ASSERT_EQ(around[b][static_cast<std::size_t>(slot)],
                found == numbers.end() ? k_no_block : found->second);
    }
  }
}

}  // namespace block_map_test
}  // namespace mallow

#include "surface/cell_lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <bitset>
#include <random>

#include "levels.h"
#include "surface/dual_cells.h"

namespace mallow {
namespace cell_lanes_test {

const CellLanes& lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, cell_lanes);
}

/// Two blocks along each axis, number 4 x + 2 y + z, each bit set with some probability.
struct Voxels {
  std::array<BlockBits, 8> blocks{};

  Voxels(double share, std::mt19937& random) {
    std::bernoulli_distribution inside(share);
    for (BlockBits& block : blocks)
      for (std::uint64_t& word : block.at)
        for (int bit = 0; bit < 64; ++bit) word |= std::uint64_t{inside(random)} << bit;
  }
  bool inside(int x, int y, int z) const {
    const auto block = static_cast<std::size_t>(4 * (x / 8) + 2 * (y / 8) + z / 8);
    return (blocks[block].at[x % 8] >> (8 * (y % 8) + z % 8) & 1) != 0;
  }
  unsigned corners(int x, int y, int z) const {
    unsigned bits = 0;
    for (int c = 0; c < 8; ++c) bits |= unsigned{inside(x + (c >> 2), y + (c >> 1 & 1), z + (c & 1))} << c;
    return bits;
  }
};

void expect_as_counted(const Voxels& voxels, const CornerBits& corners, const CellBits& cells,
                       std::bitset<256>& seen) {
  std::uint32_t cut_cells = 0, cut_edges = 0;
  for (int x = 0; x < 8; ++x) {
    for (int bit = 0; bit < 64; ++bit) {
      const int y = bit / 8, z = bit % 8;
      const unsigned inside = voxels.corners(x, y, z);
      seen.set(inside);
      for (int c = 0; c < 8; ++c) ASSERT_EQ(corners.at[c & 3][x + (c >> 2)] >> bit & 1, inside >> c & 1);
      const bool cut = inside != 0 && inside != 255;
      ASSERT_EQ(cells.cut.at[x] >> bit & 1, cut);
      cut_cells += cut;
      if (cells.cells == 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const bool edge = (inside & 1) != (inside >> (4 >> axis) & 1);
        ASSERT_EQ(cells.edges[axis].at[x] >> bit & 1, edge);
        cut_edges += edge;
      }
      if (k_cell_patches[inside].count > 1 || k_cell_patches[inside].twice >= 0) {
        ASSERT_EQ(cells.unclear.at[x] >> bit & 1, 1u) << inside;
      }
      if (!cut) continue;
      ASSERT_TRUE(cells.range.first_x <= x && x <= cells.range.last_x);
      ASSERT_TRUE(cells.range.first_y <= y && y <= cells.range.last_y);
    }
  }
  ASSERT_EQ(cells.cells, cut_cells);
  ASSERT_EQ(cells.quads, cut_edges);
}

TEST(cell_lanes, bits_of_cells_are_what_their_corners_say) {
  for (const InstructionLevel level : levels()) {
    std::mt19937 random(1);
    std::bitset<256> seen;
    for (const double share : {0.0, 0.002, 0.03, 0.3, 0.5, 0.7, 0.98, 1.0}) {
      for (int repeat = 0; repeat < 12; ++repeat) {
        const Voxels voxels(share, random);
        std::array<const BlockBits*, 8> blocks;
        for (std::size_t k = 0; k < 8; ++k) blocks[k] = &voxels.blocks[k];
        CornerBits corners;
        CellBits cells;
        lanes(level).find_cells(blocks.data(), corners, cells);
        expect_as_counted(voxels, corners, cells, seen);
      }
    }
    EXPECT_TRUE(seen.all());
  }
}

TEST(cell_lanes, few_cells_have_to_be_looked_up) {
  unsigned unclear = 0;
  for (unsigned inside = 1; inside < 255; ++inside) {
    std::array<BlockBits, 8> blocks{};
    for (int c = 0; c < 8; ++c)
      blocks[0].at[c >> 2] |= std::uint64_t{inside >> c & 1} << (8 * (c >> 1 & 1) + (c & 1));
    std::array<const BlockBits*, 8> pointers;
    for (std::size_t k = 0; k < 8; ++k) pointers[k] = &blocks[k];
    CornerBits corners;
    CellBits cells;
    lanes(best_instruction_level()).find_cells(pointers.data(), corners, cells);
    unclear += cells.unclear.at[0] & 1;
  }
  EXPECT_LT(unclear, 140u);
}

TEST(cell_lanes, signs_and_lists_are_in_the_order_of_voxels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> distance(-1, 1);
  std::array<float, k_block_voxels> distances;
  for (float& d : distances) d = distance(random);
  distances[5] = 0.0f;
  distances[6] = -0.0f;
  for (const InstructionLevel level : levels()) {
    BlockBits inside;
    lanes(level).find_signs(distances.data(), inside);
    std::array<std::uint16_t, k_block_voxels> list, place;
    const std::size_t n = lanes(level).list_cells(inside, list.data(), place.data());
    std::size_t next = 0;
    for (std::size_t v = 0; v < distances.size(); ++v) {
      ASSERT_EQ(inside.at[v / 64] >> (v % 64) & 1, distances[v] < 0);
      if (distances[v] >= 0) continue;
      ASSERT_EQ(list[next], v);
      ASSERT_EQ(place[v], next++);
    }
    EXPECT_EQ(n, next);
  }
}

}  // namespace cell_lanes_test
}  // namespace mallow

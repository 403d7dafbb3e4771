#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "levels.h"
#include "surface/cell_lanes.h"
#include "surface/dual_cells.h"
#include "surface/quad_lanes.h"
#include "surface/vertex_lanes.h"

namespace mallow {
namespace mesh_lanes_test {

using Distances = std::array<float, k_block_voxels>;

/// A block in the middle of 27, of distances that know nothing of each other.
struct Blocks {
  std::array<Distances, 27> distances;
  std::array<BlockBits, 27> inside;
  CellBits cells;
  std::vector<std::uint16_t> list, edges;
  std::array<std::uint16_t, k_block_voxels> place{};

  explicit Blocks(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> distance(-1, 2);
    for (Distances& block : distances)
      for (float& d : block) d = distance(random);
    const CellLanes& lanes = MALLOW_SELECT(InstructionLevel::baseline, cell_lanes);
    for (std::size_t b = 0; b < 27; ++b) lanes.find_signs(distances[b].data(), inside[b]);
    std::array<const BlockBits*, 8> above;
    for (std::size_t k = 0; k < 8; ++k) above[k] = &inside[13 + 9 * (k >> 2) + 3 * (k >> 1 & 1) + (k & 1)];
    CornerBits corners;
    lanes.find_cells(above.data(), corners, cells);
    list.resize(k_block_voxels + k_list_room);
    lanes.list_cells(cells.cut, list.data(), place.data());
    for (std::size_t i = 0; i < list.size(); ++i)
      edges.push_back(static_cast<std::uint16_t>(random() & k_all_edges));
  }

  /// Of a voxel from the middle block's first one on, or beside that block.
  double distance(const Eigen::Vector3i& voxel) const {
    std::size_t block = 0, at = 0;
    for (const int x : voxel) {
      block = 3 * block + static_cast<std::size_t>((x + 8) / 8);
      at = 8 * at + static_cast<std::size_t>((x + 8) % 8);
    }
    return static_cast<double>(distances[block][at]);
  }

  /// Local places, vertices and normals.
  std::vector<float> vertices(InstructionLevel level, std::size_t count, bool patched) const {
    VertexBlock block;
    for (std::size_t b = 0; b < 27; ++b) block.distances[b] = distances[b].data();
    block.range = cells.range;
    for (int a = 0; a < 3; ++a) {
      block.first[a] = 8.0 * (a + 1);
      block.origin[a] = 0.1 * a - 1;
    }
    block.voxel_size = 0.03;
    std::vector<float> rows(9 * count + 3, -7.0f);  // one more vector, for what is written too far
    const VertexLanes& lanes = MALLOW_SELECT(level, vertex_lanes);
    lanes.place_vertices(block, {count, list.data(), patched ? edges.data() : nullptr},
                         {rows.data(), rows.data() + 3 * count, rows.data() + 6 * count});
    return rows;
  }

  std::vector<std::uint32_t> triangles(InstructionLevel level, const std::vector<float>& local,
                                       const std::vector<PatchedCell>& patched) const {
    QuadBlock block{};
    for (std::uint32_t k = 0; k < 8; ++k)
      block.around[k] = {place.data(), 512 * k, patched.data(), patched.size()};
    block.inside = &inside[13];
    block.range = cells.range;
    block.edges = cells.edges;
    block.patch_of_edge = k_patch_of_edge.at[0];
    block.local = local.data();
    block.first_in_mesh = 1000;
    std::vector<std::uint32_t> to(6 * cells.quads + 1, 77);
    const QuadLanes& lanes = MALLOW_SELECT(level, quad_lanes);
    lanes.write_quads(block, to.data());
    return to;
  }
};

TEST(mesh_lanes, vertices_have_the_same_bits_at_every_instruction_level_and_stay_in_their_rows) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Blocks blocks(seed);
    for (const bool patched : {false, true}) {
      for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{9},
                                      std::size_t{blocks.cells.cells}}) {
        const std::vector<float> baseline = blocks.vertices(InstructionLevel::baseline, count, patched);
        ASSERT_EQ(baseline[9 * count], -7.0f);
        for (const InstructionLevel level : levels()) {
          const std::vector<float> other = blocks.vertices(level, count, patched);
          ASSERT_EQ(std::memcmp(baseline.data(), other.data(), baseline.size() * sizeof(float)), 0)
              << static_cast<int>(level) << ' ' << count;
        }
      }
    }
  }
}

/// Where the surface cuts a cell's edges, in the mean, from the cell's lowest corner on; in double.
Eigen::Vector3d literal_place(const Blocks& blocks, const Eigen::Vector3i& cell) {
  Eigen::Vector3d sum(0, 0, 0);
  int count = 0;
  for (int e = 0; e < k_cell_edges; ++e) {
    const auto [low, high] = edge_corners(e);
    const Eigen::Vector3i from(low >> 2, low >> 1 & 1, low & 1), to(high >> 2, high >> 1 & 1, high & 1);
    const double a = blocks.distance(cell + from), b = blocks.distance(cell + to);
    if ((a < 0) == (b < 0)) continue;
    sum += from.cast<double>() + std::clamp(a / (a - b), 0.01, 0.99) * (to - from).cast<double>();
    ++count;
  }
  return sum / count;
}

/// Differences of the voxels around a cell's corners, interpolated at a place in it.
Eigen::Vector3d literal_slope(const Blocks& blocks, const Eigen::Vector3i& cell, const Eigen::Vector3d& at) {
  Eigen::Vector3d slope(0, 0, 0);
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3i corner(c >> 2, c >> 1 & 1, c & 1);
    double weight = 1;
    for (Eigen::Index a = 0; a < 3; ++a) weight *= corner[a] == 1 ? at[a] : 1 - at[a];
    for (Eigen::Index a = 0; a < 3; ++a) {
      const Eigen::Vector3i step = Eigen::Vector3i::Unit(a);
      slope[a] += weight * (blocks.distance(cell + corner + step) - blocks.distance(cell + corner - step));
    }
  }
  return slope;
}

TEST(mesh_lanes, a_vertex_is_the_mean_of_cuts_and_its_normal_the_slope_there) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Blocks blocks(seed);
    const std::size_t n = blocks.cells.cells;
    ASSERT_GT(n, 400u);
    const std::vector<float> rows = blocks.vertices(best_instruction_level(), n, false);
    for (std::size_t v = 0; v < n; ++v) {
      const auto row = [&](std::size_t column) {
        const float* const x = rows.data() + 3 * (column * n + v);
        return Eigen::Vector3d(static_cast<double>(x[0]), static_cast<double>(x[1]),
                               static_cast<double>(x[2]));
      };
      const Eigen::Vector3i cell(blocks.list[v] / 64, blocks.list[v] / 8 % 8, blocks.list[v] % 8);
      const Eigen::Vector3d place = literal_place(blocks, cell), local = cell.cast<double>() + place;
      ASSERT_LT((row(0) - local).norm(), 2e-6);
      const Eigen::Vector3d world =
          Eigen::Vector3d(-1, -0.9, -0.8) + 0.03 * (Eigen::Vector3d(8, 16, 24) + local);
      ASSERT_LT((row(1) - world).norm(), 2e-7);
      const Eigen::Vector3d slope = literal_slope(blocks, cell, place);
      ASSERT_LT((row(2) - slope.normalized()).norm(), 1e-5 / std::min(1.0, slope.norm()));
    }
  }
}

TEST(mesh_lanes, quads_are_the_same_at_every_instruction_level_and_stay_in_their_rows) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 8);
  std::vector<float> local(3 * (8 * 512 + 4) + 1);
  for (float& x : local) x = place(random);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Blocks blocks(seed);
    std::vector<PatchedCell> patched;
    for (std::uint16_t cell = 0; cell < k_block_voxels; cell += 3)
      patched.push_back({cell, static_cast<std::uint16_t>(random() % 512)});
    for (const auto& cells : {std::vector<PatchedCell>{}, patched}) {
      const std::vector<std::uint32_t> baseline = blocks.triangles(InstructionLevel::baseline, local, cells);
      ASSERT_EQ(baseline.back(), 77u);
      for (const InstructionLevel level : levels())
        ASSERT_EQ(blocks.triangles(level, local, cells), baseline) << static_cast<int>(level);
    }
  }
}

}  // namespace mesh_lanes_test
}  // namespace mallow

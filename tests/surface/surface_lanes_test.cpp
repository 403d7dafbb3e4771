#include "surface/surface_lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <vector>

#include "levels.h"
#include "surface/node_weights.h"

namespace mallow {
namespace surface_lanes_test {

constexpr SurfaceShape k_shape{.voxel_size = 0.1f,
                               .offset = 0.275f,
                               .extra_offset = 0.02f,
                               .spread = 0.0375f,
                               .extra_spread = 0.2625f,
                               .full_weight = 5.1f,
                               .least_weight = 0.02f,
                               .threshold = 0.5f,
                               .background = 3.0f};

/// Vectors in a box of side 2, with room to be read in eights.
struct Cloud {
  std::vector<float> x, y, z;
  std::size_t count;

  Cloud(std::size_t n, unsigned seed) : count(n) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> inside(-1, 1);
    for (std::vector<float>* axis : {&x, &y, &z})
      for (std::size_t i = 0; i < n + k_cluster; ++i) axis->push_back(inside(random));
  }
  ConstVectors raw() const { return {x.data(), y.data(), z.data()}; }
};

const SurfaceLanes& lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, surface_lanes);
}

/// What all lanes give for one cloud of particles, one after another.
std::vector<float> everything(InstructionLevel level) {
  const SurfaceLanes& k = lanes(level);
  const Cloud particles(71, 1), points(128, 2), values(5 * 128, 3);
  std::vector<float> all(128 + 2 * k_block_voxels + 128 + (k_moments + 1) * 128);
  float* const distances = all.data();
  k.distances(k_shape, values.x.data(), 128, distances);
  NodeRows rows;
  rows.stride = 125;
  for (std::size_t row = 0; row < k_nodes * k_nodes; ++row) {
    rows.four[row] = values.x.data() + row * k_nodes;
    rows.fifth[row] = rows.four[row] + k_nodes - 1;
  }
  float* const block = distances + 128;
  k.fill_block(k_shape, cubic_weights(2, 0), rows, block);
  k.fill_block(k_shape, cubic_weights(4, 1), rows, block + k_block_voxels);
  std::vector<float> squares;
  for (const float x : values.x) squares.push_back(x * x);
  float* const spheres = block + 2 * k_block_voxels;
  k.sphere_distances(k_shape, squares.data(), 128, spheres);
  float* const moments = spheres + 128;
  k.moments_at_points(points.raw(), 128, particles.raw(), particles.count, moments);
  k.density_distances(k_shape, values.x.data(), 128, moments + k_moments * 128);
  return all;
}

TEST(surface_lanes, same_bits_at_every_instruction_level) {
  const std::vector<float> baseline = everything(InstructionLevel::baseline);
  for (const InstructionLevel level : levels()) {
    const std::vector<float> other = everything(level);
    EXPECT_EQ(std::memcmp(baseline.data(), other.data(), baseline.size() * sizeof(float)), 0)
        << static_cast<int>(level);
  }
}

TEST(surface_lanes, sides_are_a_bit_for_each_distance) {
  const Cloud distances(k_block_voxels, 6);
  const float far = distances.x[70], deep = distances.x[200];
  for (const InstructionLevel level : levels()) {
    for (const std::size_t n : {std::size_t{8}, std::size_t{64}, k_block_voxels}) {
      std::uint64_t outside[8] = {}, inside[8] = {};
      lanes(level).find_sides(distances.x.data(), n, far, deep, outside, inside);
      for (std::size_t k = 0; k < n; ++k) {
        ASSERT_EQ(outside[k / 64] >> k % 64 & 1, distances.x[k] >= far ? 1u : 0u);
        ASSERT_EQ(inside[k / 64] >> k % 64 & 1, distances.x[k] <= deep ? 1u : 0u);
      }
    }
  }
}

TEST(surface_lanes, no_particles_are_outside) {
  const SurfaceLanes& k = lanes(best_instruction_level());
  const std::array<float, k_sums* 8> sums = {};
  float distances[8];
  k.distances(k_shape, sums.data(), 8, distances);
  for (const float distance : distances) EXPECT_EQ(distance, 3.0f);
}

}  // namespace surface_lanes_test
}  // namespace mallow

#include "level_set/surface_kernel.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "levels.h"

namespace mallow {
namespace {

constexpr SurfaceShape k_shape{.voxel_size = 0.1f,
                               .offset = 0.275f,
                               .extra_offset = 0.02f,
                               .spread = 0.0375f,
                               .extra_spread = 0.2625f,
                               .full_weight = 5.1f,
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

const SurfaceKernels& kernels(InstructionLevel level) {
  return MALLOW_SELECT(level, surface_kernels);
}

/// What all kernels give for one cloud of particles, one after another.
std::vector<float> everything(InstructionLevel level) {
  const SurfaceKernels& k = kernels(level);
  const Cloud particles(71, 1), points(128, 2), values(71, 3);
  std::vector<float> all(k_sums * 128 + 128 + k_block_voxels + 128 + 3 * 128);
  float* const sums = all.data();
  k.sum_at_points(points.raw(), 128, particles.raw(), particles.count, sums);
  float* const distances = sums + k_sums * 128;
  k.distances(k_shape, sums, 128, distances);
  NodeWeights weights{};
  for (auto& voxel : weights.w)
    for (std::size_t n = 0; n < k_nodes; ++n) voxel[n] = 0.1f * static_cast<float>(n + 1);
  float* const block = distances + 128;
  k.fill_block(k_shape, weights, sums, block);
  float* const spheres = block + k_block_voxels;
  k.sphere_distances(k_shape, points.raw(), 128, particles.raw(), particles.count, spheres);
  float* const means = spheres + 128;
  k.mean_at_points(points.raw(), 128, particles.raw(), values.raw(), particles.count,
                   {means, means + 128, means + 256});
  return all;
}

TEST(surface_kernel, same_bits_at_every_instruction_level) {
  const std::vector<float> baseline = everything(InstructionLevel::baseline);
  for (const InstructionLevel level : levels()) {
    const std::vector<float> other = everything(level);
    EXPECT_EQ(std::memcmp(baseline.data(), other.data(), baseline.size() * sizeof(float)), 0)
        << static_cast<int>(level);
  }
}

TEST(surface_kernel, no_particles_and_far_particles_are_outside) {
  const SurfaceKernels& k = kernels(best_instruction_level());
  const Cloud points(8, 4);
  Cloud far(1, 5);
  far.x[0] = 2.5f;
  for (const std::size_t count : {0, 1}) {
    float sums[k_sums * 8], distances[8];
    k.sum_at_points(points.raw(), 8, far.raw(), count, sums);
    k.distances(k_shape, sums, 8, distances);
    for (const float distance : distances) EXPECT_EQ(distance, 3.0f);
    k.sphere_distances(k_shape, points.raw(), 8, far.raw(), count, distances);
    for (const float distance : distances) EXPECT_EQ(distance, 3.0f);
  }
}

}  // namespace
}  // namespace mallow

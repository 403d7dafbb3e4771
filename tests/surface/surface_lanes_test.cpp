#include "surface/surface_lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <vector>

#include "levels.h"

namespace mallow {
namespace surface_lanes_test {

constexpr SurfaceShape k_shape{.voxel_size = 0.1f,
                               .offset = 0.275f,
                               .extra_offset = 0.02f,
                               .spread = 0.0375f,
                               .extra_spread = 0.2625f,
                               .full_weight = 5.1f,
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
  const Cloud particles(71, 1), points(128, 2), values(71, 3);
  std::vector<float> all(k_sums * 128 + 128 + k_block_voxels + 128 + 3 * 128 +
                         (k_moments + k_density_sums + 1) * 128);
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
  float* const moments = means + 3 * 128;
  k.moments_at_points(points.raw(), 128, particles.raw(), particles.count, moments);
  std::vector<Ellipsoid> shapes;
  for (std::size_t i = 0; i < particles.count; ++i)
    shapes.push_back({.xx = 1 + values.x[i] * 0.5f,
                      .xy = 0.2f * values.y[i],
                      .xz = 0.1f,
                      .yy = 1,
                      .yz = 0.2f * values.z[i],
                      .zz = 2,
                      .weight = 0.3f,
                      .reach = {1, 1, 1}});
  float* const density = moments + k_moments * 128;
  k.density_at_points(points.raw(), 128, particles.raw(), shapes.data(), particles.count, density);
  k.density_distances(k_shape, density, 128, density + k_density_sums * 128);
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

TEST(surface_lanes, gradient_of_the_density_is_its_slope) {
  const SurfaceLanes& k = lanes(best_instruction_level());
  const Cloud particles(30, 1), at(8, 2);
  const std::vector<Ellipsoid> shapes(
      30,
      {.xx = 0.8f, .xy = 0.2f, .xz = 0.1f, .yy = 1.1f, .yz = -0.3f, .zz = 0.7f, .weight = 1, .reach = {}});
  constexpr float k_step = 1e-3f;
  const auto density = [&](int axis, float step) {
    Cloud moved = at;
    std::vector<float>& x = axis == 0 ? moved.x : axis == 1 ? moved.y : moved.z;
    for (float& value : x) value += step;
    std::array<float, k_density_sums * 8> sums;
    k.density_at_points(moved.raw(), 8, particles.raw(), shapes.data(), 30, sums.data());
    return sums;
  };
  const auto here = density(0, 0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto above = density(axis, k_step), below = density(axis, -k_step);
    for (std::size_t p = 0; p < 8; ++p)
      EXPECT_NEAR(here[static_cast<std::size_t>(axis + 1) * 8 + p], (above[p] - below[p]) / (2 * k_step),
                  0.02f);
  }
}

TEST(surface_lanes, no_particles_and_far_particles_are_outside) {
  const SurfaceLanes& k = lanes(best_instruction_level());
  const Cloud points(8, 4);
  Cloud far(1, 5);
  far.x[0] = 2.5f;
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}}) {
    float sums[k_sums * 8], distances[8];
    k.sum_at_points(points.raw(), 8, far.raw(), count, sums);
    k.distances(k_shape, sums, 8, distances);
    for (const float distance : distances) EXPECT_EQ(distance, 3.0f);
    k.sphere_distances(k_shape, points.raw(), 8, far.raw(), count, distances);
    for (const float distance : distances) EXPECT_EQ(distance, 3.0f);
  }
}

}  // namespace surface_lanes_test
}  // namespace mallow

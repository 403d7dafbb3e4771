#include "level_set/surface_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "levels.h"

namespace mallow {
namespace {

/// One particle per cubic spacing of five voxels, a kernel radius of ten voxels.
constexpr SurfaceShape k_shape{.voxel_size = 0.1f,
                               .offset = 0.275f,
                               .extra_offset = 0.02f,
                               .spread = 0.0375f,
                               .extra_spread = 0.2625f,
                               .full_weight = 5.1f,
                               .background = 3.0f,
                               .probe = false};

struct Particles {
  std::vector<float> x, y, z;
};

/// The lower half of space, shaken.
Particles half_space() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> shake(-1.5f, 1.5f);
  Particles particles;
  for (int i = -3; i <= 5; ++i)
    for (int j = -3; j <= 5; ++j)
      for (int k = -3; k <= 0; ++k) {
        particles.x.push_back(5.0f * static_cast<float>(i) + shake(random));
        particles.y.push_back(5.0f * static_cast<float>(j) + shake(random));
        particles.z.push_back(5.0f * static_cast<float>(k) + shake(random));
      }
  return particles;
}

LeafContent fill(const SurfaceShape& shape, const Particles& p, InstructionLevel level,
                 std::vector<float>& out) {
  std::vector<float> scratch(3 * p.x.size());
  out.assign(k_leaf_voxels, 99.0f);
  return select_surface_kernels(level).fill_leaf(shape, p.x.data(), p.y.data(), p.z.data(), p.x.size(),
                                                 scratch.data(), out.data());
}

/// The header comment of surface_kernel.cpp in double precision, lengths in kernel radii.
double distance_read_literally(const Particles& particles, const Eigen::Vector3d& voxel) {
  double weight = 0, square = 0;
  Eigen::Vector3d mean(0, 0, 0);
  for (std::size_t p = 0; p < particles.x.size(); ++p) {
    const Eigen::Vector3d d = 0.1 * (Eigen::Vector3d(particles.x[p], particles.y[p], particles.z[p]) - voxel);
    const double w = std::pow(std::max(0.0, 1 - d.squaredNorm()), 3);
    weight += w;
    mean += w * d;
    square += w * d.squaredNorm();
  }
  if (weight == 0) return 3;
  mean /= weight;
  const double full = std::min(1.0, 2 * weight / 5.1);
  const double excess = std::max(0.0, square / weight - mean.squaredNorm() - 0.0375 - 0.2625 * full);
  const double distance = std::sqrt(mean.squaredNorm() + 0.5 * excess) - 0.275 - 0.02 * full;
  return std::clamp(distance / 0.1, -3.0, 3.0);
}

TEST(surface_kernel, is_the_formula_of_its_source) {
  const Particles particles = half_space();
  std::vector<float> distances;
  ASSERT_EQ(fill(k_shape, particles, best_instruction_level(), distances), LeafContent::surface);
  int cut = 0;
  for (int v = 0; v < k_leaf_voxels; ++v) {
    const double expected =
        distance_read_literally(particles, Eigen::Vector3i(v / 64, v / 8 % 8, v % 8).cast<double>());
    EXPECT_NEAR(distances[static_cast<std::size_t>(v)], expected, 1e-4) << "voxel " << v;
    cut += std::abs(expected) == 3;
  }
  EXPECT_LT(cut, k_leaf_voxels / 2);
}

TEST(surface_kernel, same_bits_at_every_instruction_level) {
  const Particles particles = half_space();
  std::vector<float> baseline, other;
  fill(k_shape, particles, InstructionLevel::baseline, baseline);
  for (const InstructionLevel level : levels()) {
    fill(k_shape, particles, level, other);
    EXPECT_EQ(std::memcmp(baseline.data(), other.data(), k_leaf_voxels * sizeof(float)), 0)
        << static_cast<int>(level);
  }
}

TEST(surface_kernel, probing_leaves_out_only_what_has_no_surface) {
  SurfaceShape probing = k_shape;
  probing.probe = true;
  int left_out[2] = {0, 0};
  for (float shift = -40; shift <= 25; shift += 1) {
    Particles particles = half_space();
    for (float& z : particles.z) z += shift;
    std::vector<float> all, probed;
    fill(k_shape, particles, best_instruction_level(), all);
    const LeafContent content = fill(probing, particles, best_instruction_level(), probed);
    if (content == LeafContent::surface) {
      EXPECT_EQ(all, probed) << shift;
      continue;
    }
    ++left_out[content == LeafContent::inside];
    for (const float distance : all) ASSERT_EQ(distance < 0, content == LeafContent::inside) << shift;
  }
  EXPECT_GT(left_out[0], 5);
  EXPECT_GT(left_out[1], 2);
}

TEST(surface_kernel, no_particles_and_far_particles_are_outside) {
  std::vector<float> distances;
  fill(k_shape, {}, best_instruction_level(), distances);
  for (const float distance : distances) ASSERT_EQ(distance, 3.0f);
  fill(k_shape, {{-9.9999995f}, {0}, {0}}, best_instruction_level(), distances);
  for (const float distance : distances) ASSERT_EQ(distance, 3.0f);
}

}  // namespace
}  // namespace mallow

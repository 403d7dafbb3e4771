#include "surface/sum_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "levels.h"

namespace mallow {
namespace sum_lanes_test {

const SumLanes& lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, sum_lanes);
}

constexpr float k_voxel = 0.19f;
constexpr BlockBox k_box{.low = {0.1f, 0.2f, 0.3f},
                         .high = {1.1f, 1.2f, 1.3f},
                         .squared_reach = 0.49f,
                         .corner = {0.1, 0.2, 0.3},
                         .per_radius = 1 / 0.7};

ConstVectors raw(const std::vector<float>* axes) {
  return {axes[0].data(), axes[1].data(), axes[2].data()};
}

/// Particles with kernels and values of their own within two kernel radii of a block, with room for lanes.
struct Particles {
  std::vector<float> axes[3], values[3], reach[3];
  std::vector<Ellipsoid> shapes;
  std::vector<std::uint32_t> listed;
  std::size_t count;

  explicit Particles(std::size_t n) : listed(NearColumns::k_lists * (n + k_cluster)), count(n) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-2, 7 * k_voxel + 2), value(-1, 1);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < n + k_cluster; ++i) {
        axes[a].push_back(i < n ? place(random) : NearColumns::k_far);
        values[a].push_back(value(random));
        reach[a].push_back(0.9f + 0.05f * static_cast<float>(a));
      }
    }
    // Diagonal kernels, whose boxes are known.
    for (std::size_t i = 0; i < n; ++i)
      shapes.push_back({.xx = 1 / 0.9f,
                        .xy = 0,
                        .xz = 0,
                        .yy = 1 / 0.95f,
                        .yz = 0,
                        .zz = 1,
                        .weight = 0.5f + 0.1f * values[0][i],
                        .reach = {0.9f, 0.95f, 1}});
  }
  NearColumns near() { return {raw(axes), count, listed.data()}; }
};

/// What all lanes give, one after another.
std::vector<float> everything(InstructionLevel level) {
  const SumLanes& k = lanes(level);
  Particles p(300);
  std::vector<float> all;
  const auto room = [&](std::size_t n) {
    all.resize(all.size() + n);
    return all.data() + all.size() - n;
  };
  for (const int step : {1, 2, 4}) {
    const PointLattice lattice{step, k_voxel};
    k.sum(lattice, p.near(), room(k_sums * lattice.count()));
    k.nearest(lattice, p.near(), 0.99f, room(lattice.count()));
    k.density(lattice, p.near(), p.shapes.data(), raw(p.reach), room(k_density_sums * lattice.count()));
  }
  float* const means = room(3 * 96);
  k.mean(raw(p.values), 96, p.near(), raw(p.values), {means, means + 96, means + 192});
  const std::size_t n = p.count + k_cluster;
  std::vector<std::uint32_t> which(n);
  float* const near = room(3 * n);
  const std::size_t picked =
      k.pick_near(k_box, raw(p.axes), p.count, {near, near + n, near + 2 * n}, which.data());
  for (std::size_t a = 0; a < 3; ++a) std::fill(near + a * n + picked, near + (a + 1) * n, 0.0f);
  for (std::size_t i = 0; i < picked; ++i) all.push_back(static_cast<float>(which[i]));
  return all;
}

TEST(sum_lanes, same_bits_at_every_instruction_level) {
  const std::vector<float> baseline = everything(InstructionLevel::baseline);
  for (const InstructionLevel level : levels()) {
    const std::vector<float> other = everything(level);
    ASSERT_EQ(baseline.size(), other.size());
    EXPECT_EQ(std::memcmp(baseline.data(), other.data(), baseline.size() * sizeof(float)), 0)
        << static_cast<int>(level);
  }
}

/// Calls visit(number, x, y, z) for the points of a lattice.
template <class Visit>
void for_each_point(const PointLattice& lattice, const Visit& visit) {
  std::size_t number = 0;
  const auto at = [&](int k) { return static_cast<float>(k * lattice.step) * lattice.voxel; };
  for (int i = 0; i < lattice.side(); ++i)
    for (int j = 0; j < lattice.side(); ++j)
      for (int k = 0; k < lattice.side(); ++k) visit(number++, at(i), at(j), at(k));
}

TEST(sum_lanes, sums_have_the_bits_of_sums_over_all_particles_in_their_order) {
  Particles p(300);
  for (const int step : {1, 2, 4}) {
    const PointLattice lattice{step, k_voxel};
    const std::size_t n = lattice.count();
    std::vector<float> sums(k_sums * n), squares(n);
    lanes(best_instruction_level()).sum(lattice, p.near(), sums.data());
    lanes(best_instruction_level()).nearest(lattice, p.near(), 0.99f, squares.data());
    for_each_point(lattice, [&](std::size_t at, float x, float y, float z) {
      std::array<float, k_sums> literal = {};
      float least = 0.99f;
      for (std::size_t i = 0; i < p.count; ++i) {
        const float d[3] = {p.axes[0][i] - x, p.axes[1][i] - y, p.axes[2][i] - z};
        const float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], t = std::max(1 - square, 0.0f);
        const float w = t * t * t;
        literal[0] += w;
        for (std::size_t a = 0; a < 3; ++a) literal[a + 1] += w * d[a];
        literal[4] += w * square;
        least = std::min(least, square);
      }
      for (std::size_t s = 0; s < k_sums; ++s) ASSERT_EQ(sums[s * n + at], literal[s]);
      ASSERT_EQ(squares[at], least);
    });
  }
}

TEST(sum_lanes, densities_are_those_of_all_particles) {
  Particles p(300);
  const PointLattice lattice{1, k_voxel};
  std::vector<float> sums(k_density_sums * lattice.count());
  lanes(best_instruction_level()).density(lattice, p.near(), p.shapes.data(), raw(p.reach), sums.data());
  for_each_point(lattice, [&](std::size_t at, float x, float y, float z) {
    double literal = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
      const double q[3] = {(p.axes[0][i] - x) / 0.9, (p.axes[1][i] - y) / 0.95, p.axes[2][i] - z};
      literal += p.shapes[i].weight * std::pow(std::max(0.0, 1 - q[0] * q[0] - q[1] * q[1] - q[2] * q[2]), 3);
    }
    ASSERT_NEAR(sums[at], literal, 2e-6);
  });
}

TEST(sum_lanes, gradient_of_the_density_is_its_slope) {
  Particles p(60);
  for (Ellipsoid& shape : p.shapes) {
    shape.xy = 0.2f;
    shape.yz = -0.3f;
  }
  for (std::vector<float>& reach : p.reach) std::fill(reach.begin(), reach.end(), 3.0f);
  const PointLattice lattice{4, k_voxel};
  constexpr float k_step = 1e-3f;
  const auto density = [&](std::size_t axis, float step) {
    Particles moved = p;
    for (float& x : moved.axes[axis]) x -= step;
    std::array<float, k_density_sums * 8> sums;
    lanes(best_instruction_level())
        .density(lattice, moved.near(), moved.shapes.data(), raw(moved.reach), sums.data());
    return sums;
  };
  const auto here = density(0, 0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto above = density(axis, k_step), below = density(axis, -k_step);
    for (std::size_t at = 0; at < 8; ++at)
      EXPECT_NEAR(here[(axis + 1) * 8 + at], (above[at] - below[at]) / (2 * k_step), 0.02f);
  }
}

TEST(sum_lanes, particles_within_a_radius_of_the_block_are_picked) {
  Particles p(300);
  const std::size_t n = p.count + k_cluster;
  std::vector<float> near[3] = {std::vector<float>(n), std::vector<float>(n), std::vector<float>(n)};
  std::vector<std::uint32_t> which(n);
  const std::size_t picked = lanes(best_instruction_level())
                                 .pick_near(k_box, raw(p.axes), p.count,
                                            {near[0].data(), near[1].data(), near[2].data()}, which.data());
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < p.count; ++i) {
    double square = 0, offset[3];
    for (std::size_t a = 0; a < 3; ++a) {
      offset[a] = (static_cast<double>(p.axes[a][i]) - k_box.corner[a]) * k_box.per_radius;
      square += std::pow(std::max({0.0, -offset[a], offset[a] - k_box.per_radius}), 2);
    }
    if (square > 1) continue;
    ASSERT_LT(next, picked);
    EXPECT_EQ(which[next], i);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(near[a][next], static_cast<float>(offset[a]));
    ++next;
  }
  EXPECT_EQ(next, picked);
  EXPECT_GT(picked, 20u);
}

}  // namespace sum_lanes_test
}  // namespace mallow

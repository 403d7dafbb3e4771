#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "levels.h"
#include "sph/kernel_functions.h"
#include "sph/sph.h"

namespace mallow {
namespace sph_test {

constexpr double k_pi = std::numbers::pi;

/// ∫ f(q) 4π q² dq over the unit ball, by the midpoint rule.
template <class F>
double ball_integral(const F& f) {
  constexpr int n = 20000;
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double q = (k + 0.5) / n;
    sum += f(q) * 4 * k_pi * q * q / n;
  }
  return sum;
}

TEST(kernel_functions, poly6_integrates_to_one_in_any_unit) {
  for (const double s : {1e-3, 0.5, 2.9, 1e3}) {
    const double factor = static_cast<double>(kernel_factors(s).density);
    EXPECT_NEAR(ball_integral([](double q) { return std::pow(1 - q * q, 3); }) * factor * s * s * s, 1.0,
                1e-6);
  }
}

TEST(kernel_functions, gradients_are_the_derivatives_of_their_kernels) {
  const double s = 1.7, q = 0.4, r = q * s, e = 1e-5;
  const KernelFactors f = kernel_factors(s);
  const auto poly6 = [&](double x) {
    return 315 / (64 * k_pi * std::pow(s, 9)) * std::pow(s * s - x * x, 3);
  };
  const auto spiky = [&](double x) { return 15 / (k_pi * std::pow(s, 6)) * std::pow(s - x, 3); };
  EXPECT_NEAR(-static_cast<double>(f.poly6_gradient) * std::pow(1 - q * q, 2) * r,
              (poly6(r + e) - poly6(r - e)) / (2 * e), 1e-6);
  EXPECT_NEAR(-static_cast<double>(f.spiky_gradient) * std::pow(1 - q, 2),
              (spiky(r + e) - spiky(r - e)) / (2 * e), 1e-6);
  // ∇²W = W'' + 2 W'/r
  const double d1 = (poly6(r + e) - poly6(r - e)) / (2 * e),
               d2 = (poly6(r + e) - 2 * poly6(r) + poly6(r - e)) / (e * e);
  EXPECT_NEAR(-static_cast<double>(f.poly6_laplacian) * (1 - q * q) * (3 - 7 * q * q), d2 + 2 * d1 / r, 1e-5);
}

/// Two groups of random particles under σ = 1, with everything that pairs can have.
struct World {
  VectorColumn x, v;
  Sph sph;

  explicit World(Formulation formulation = Formulation::conservative, std::size_t n = 700) : x(n), v(n) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> coordinate(0, 4);
    for (std::size_t i = 0; i < n; ++i) {
      x.set(i, {coordinate(random), coordinate(random), coordinate(random)});
      v.set(i, {coordinate(random) - 2, coordinate(random) - 2, coordinate(random) - 2});
    }
    x.set(5, x.get(4));  // coincident
    sph.support_radius = 1;
    sph.factors = kernel_factors(1);
    sph.formulation = formulation;
    sph.viscous = true;
    sph.groups = {{1.0f, 9.0f, 1.0f / 9, 1.0f / 9, 16, 0.9f, 0.5f, 0.3f},
                  {3.0f, 40.0f, 3.0f / 40, 3.0f / 40, 4, 1, 0.1f, 0}};
    sph.bodies = {{n / 2, 0}, {n, 1}};
  }
  void run(int threads, InstructionLevel level) {
    find_neighbors(x, {threads, level}, sph);
    compute_density({threads, level}, sph);
    compute_accelerations(v, {{}, {}}, {threads, level}, sph);
  }
  double mass(std::size_t row) const {
    return static_cast<double>(sph.groups[row < sph.bodies[0].end ? 0 : 1].mass);
  }
};

TEST(density, of_a_full_lattice_is_the_rest_density) {
  VectorColumn x(11 * 11 * 11);
  for (int i = 0; i < 11 * 11 * 11; ++i)
    x.set(static_cast<std::size_t>(i), Eigen::Vector3i(i % 11, i / 11 % 11, i / 121).cast<float>());
  Sph sph;
  sph.support_radius = 2.9f;
  sph.factors = kernel_factors(2.9);
  const double rho0 = lattice_density(2.9, 1);
  sph.groups = {
      {1, static_cast<float>(rho0), static_cast<float>(1 / rho0), static_cast<float>(1 / rho0), 16, 1, 0, 0}};
  sph.bodies = {{x.size(), 0}};
  find_neighbors(x, {2, best_instruction_level()}, sph);
  compute_density({2, best_instruction_level()}, sph);
  EXPECT_NEAR(static_cast<double>(sph.density_by_row[5 + 5 * 11 + 5 * 121]) / rho0, 1.0, 1e-6);
}

// The printed sums are not antisymmetric: that is why they are not the default (model 1).
TEST(accelerations, conservative_pairs_keep_momentum_and_printed_ones_do_not) {
  for (const Formulation formulation : {Formulation::conservative, Formulation::printed}) {
    World world(formulation);
    world.run(2, best_instruction_level());
    Eigen::Vector3d total(0, 0, 0);
    double size = 0;
    for (std::size_t i = 0; i < world.x.size(); ++i) {
      // The paper's force is per volume: momentum is Σ (m/ρ) ρ a.
      const Eigen::Vector3d a = (world.sph.acceleration.get(i) + world.sph.cross_group.get(i)).cast<double>();
      total += world.mass(i) * a;
      size += world.mass(i) * a.norm();
    }
    if (formulation == Formulation::conservative)
      EXPECT_LT(total.norm(), 1e-6 * size);
    else
      EXPECT_GT(total.norm(), 1e-3 * size);
  }
}

TEST(accelerations, have_the_same_bits_at_every_level_and_thread_count) {
  for (const Formulation formulation : {Formulation::conservative, Formulation::printed}) {
    World reference(formulation);
    reference.run(1, InstructionLevel::baseline);
    for (const InstructionLevel level : levels()) {
      for (const int threads : {1, 2, 3}) {
        World world(formulation);
        world.run(threads, level);
        for (std::size_t i = 0; i < world.x.size(); ++i) {
          ASSERT_EQ(world.sph.density_by_row[i], reference.sph.density_by_row[i]);
          ASSERT_EQ(world.sph.acceleration.get(i), reference.sph.acceleration.get(i));
          ASSERT_EQ(world.sph.cross_group.get(i), reference.sph.cross_group.get(i));
        }
      }
    }
  }
}

TEST(density, leaves_in_the_lists_who_is_within_the_radius_of_the_cluster) {
  World world;
  find_neighbors(world.x, {2, best_instruction_level()}, world.sph);
  const std::size_t listed = world.sph.lists.total;
  compute_density({2, best_instruction_level()}, world.sph);
  std::size_t near = 0;
  const CellGrid& grid = world.sph.grid;
  for (std::size_t c = 0; c < grid.clusters(); ++c) {
    const auto list = world.sph.lists.of(c);
    near += list.size();
    for (std::size_t j = 0; j < world.x.size(); ++j) {
      float nearest = 2;
      for (std::size_t i = grid.cluster_start[c]; i < grid.cluster_start[c + 1]; ++i)
        nearest = std::min(nearest, (grid.sorted.get(i) - grid.sorted.get(j)).norm());
      const bool kept = std::find(list.begin(), list.end(), j) != list.end();
      EXPECT_TRUE(kept || nearest > 0.999999f) << c << ' ' << j;
    }
  }
  EXPECT_LT(near, listed);
}

TEST(accelerations, of_coincident_particles_are_finite) {
  World world;
  world.run(1, best_instruction_level());
  EXPECT_TRUE(world.sph.acceleration.get(4).allFinite());
  EXPECT_TRUE(world.sph.acceleration.get(5).allFinite());
}

TEST(sph, without_viscosity_and_with_one_group_owns_no_columns_for_them) {
  World world;
  world.sph.viscous = false;
  world.sph.groups.resize(1);
  world.sph.bodies = {{world.x.size(), 0}};
  world.run(1, best_instruction_level());
  EXPECT_EQ(world.sph.velocity.bytes() + world.sph.group.bytes() + world.sph.cross_group.bytes(), 0u);
}

}  // namespace sph_test
}  // namespace mallow

// What keeps densities from rising above those at rest: volume_iterations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "mallow/mallow.h"
#include "sph/kernel_functions.h"
#include "sph/sph.h"

namespace mallow {
namespace volume_test {

using Vec = Eigen::Vector3d;

SolverConfig config(int iterations, float tolerance = 0) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, -0.3f},
          .volume_iterations = iterations,
          .volume_tolerance = tolerance,
          .sleep_speed = 0.0f,
          .threads = 2};
}

/// ρ/ρ0 of the particle where that is largest.
double worst_density(Simulation& s) {
  double worst = 0;
  const std::vector<BodyInfo> bodies = s.info().bodies;  // in the order of their rows
  const std::vector<BodyId> ids = s.bodies();
  for (std::size_t b = 0; b < ids.size(); ++b) {
    const Simulation::Rows rows = s.rows(ids[b]);
    for (const float density : s.densities().subspan(rows.begin, rows.end - rows.begin))
      worst = std::max(worst, static_cast<double>(density / bodies[b].rest_density));
  }
  return worst;
}

TEST(lattice, sums_wendlands_kernel_and_the_squares_of_its_gradients_up_to_their_integrals) {
  for (const double sigma : {2.0, 2.9, 17.0}) {
    double sum = 0, squares = 0;
    for (int x = -17; x <= 17; ++x)
      for (int y = -17; y <= 17; ++y)
        for (int z = -17; z <= 17; ++z) {
          const double r = std::sqrt(x * x + y * y + z * z), t = 1 - r / sigma;
          if (t > 0) sum += std::pow(t, 4) * (1 + 4 * r / sigma);
          if (t > 0) squares += r * r * std::pow(t, 6);
        }
    EXPECT_NEAR(wendland_lattice_sum(sigma, 1) / sum, 1, 1e-12);
    EXPECT_NEAR(wendland_lattice_squares(sigma, 1) / squares, 1, 1e-12);
  }
  EXPECT_NEAR(wendland_lattice_sum(65, 1) / wendland_lattice_sum(63.9, 1), std::pow(65 / 63.9, 3), 1e-4);
  EXPECT_NEAR(wendland_lattice_squares(65, 1) / wendland_lattice_squares(63.9, 1), std::pow(65 / 63.9, 5),
              1e-4);
}

/// ρ/ρ0 as poly6 has it, which is what model 2 measures, of bodies of one spacing and a mass of 1.
class Poly6Densities {
 public:
  Poly6Densities(double radius, double spacing) : rest_(lattice_density(radius, spacing)) {
    sph_.support_radius = static_cast<float>(radius);
    sph_.factors = kernel_factors(radius);
    const auto rest = static_cast<float>(rest_), volume = static_cast<float>(1 / rest_);
    sph_.groups = {{.mass = 1,
                    .rest_density = rest,
                    .rest_volume = volume,
                    .kernel_volume = volume,
                    .pressure_coefficient = 0,
                    .contact_share = 1,
                    .viscosity = 0,
                    .cohesion = 0}};
  }
  std::span<const float> of(const Simulation& s) {
    VectorColumn x(s.particle_count());
    for (std::size_t row = 0; row < x.size(); ++row) x.set(row, s.positions()[row]);
    sph_.bodies = {{x.size(), 0}};
    const Execution execution{2, best_instruction_level()};
    find_neighbors(x, execution, sph_);
    compute_density(execution, sph_);
    return sph_.density_by_row.span();
  }
  double worst(const Simulation& s) { return static_cast<double>(std::ranges::max(of(s))) / rest_; }
  double rest() const { return rest_; }

 private:
  double rest_;
  Sph sph_;
};

/// The cube of 15³ of the paper's Table 1, dropped.
struct Dropped {
  double impact = 0, rest = 0;  ///< worst ρ/ρ0 of all, and of the last 50 steps
  double volume = 0;            ///< at the end, in that at rest
  double iterations = 0;        ///< a step
};
Dropped drop(float alpha, int iterations, float tolerance = 0, std::optional<float> pressure = 0.0f) {
  constexpr float k_spacing = 22.0f / 15;
  SolverConfig solver = config(iterations, tolerance);
  solver.support_radius = 2.9f;
  solver.update_interval = 20;
  solver.wall_pressure = false;
  solver.acoustic_limit = pressure != 16.0f;
  Simulation s(solver);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.add_body(sample(Lattice{.count = {15, 15, 15}, .spacing = k_spacing, .corner = {0, 0, 10}, .jitter = 0}),
             {.alpha = alpha, .update_threshold = 1.0f, .pressure_coefficient = pressure, .viscosity = 0.5f});
  Poly6Densities densities(2.9, static_cast<double>(k_spacing));
  Dropped dropped;
  constexpr int k_steps = 400;
  for (int k = 0; k < k_steps; ++k) {
    dropped.iterations += 1.0 * s.step().volume_iterations / k_steps;
    const double worst = densities.worst(s);
    dropped.impact = std::max(dropped.impact, worst);
    if (k >= k_steps - 50) dropped.rest = std::max(dropped.rest, worst);
  }
  for (const float density : densities.of(s))
    dropped.volume += 1 / std::max(1.0, static_cast<double>(density) / densities.rest());
  dropped.volume /= static_cast<double>(s.particle_count());
  return dropped;
}

TEST(volume, of_a_dropped_cube_is_as_the_prototype_says_at_1_2_3_iterations_and_to_tolerance) {
  constexpr int k_iterations[] = {1, 2, 3, 50};  // the last to the tolerance
  struct Row {
    float alpha;
    double impact[4], impact_room[4], rest[4], rest_room[4], most_iterations;
  };
  // Of model 2, section 2, where densities are poly6's for the constraint too. Within 0.03 where nothing else
  // is measured: bench/PHYSICS.md says why some are not. More than 0.03 below are those at rest alone.
  const Row rows[] = {{0.0f,
                       {1.21, 1.19, 1.17, 1.06},
                       {0.055, 0.03, 0.03, 0.03},
                       {1.06, 1.04, 1.03, 1.03},
                       {0.03, 0.04, 0.03, 0.03},
                       7.9},
                      {0.3f,
                       {1.28, 1.22, 1.21, 1.04},
                       {0.03, 0.03, 0.03, 0.04},
                       {1.06, 1.03, 1.02, 1.02},
                       {0.055, 0.03, 0.03, 0.03},
                       7.1},
                      {0.7f,
                       {1.23, 1.19, 1.18, 1.04},
                       {0.045, 0.03, 0.03, 0.04},
                       {1.04, 1.02, 1.02, 1.02},
                       {0.03, 0.03, 0.03, 0.03},
                       6.5},
                      {1.0f,
                       {1.23, 1.19, 1.18, 1.04},
                       {0.055, 0.03, 0.03, 0.035},
                       {1.03, 1.02, 1.01, 1.02},
                       {0.03, 0.03, 0.03, 0.03},
                       2.6}};
  for (const Row& row : rows)
    for (int k = 0; k < 4; ++k) {
      const bool to_tolerance = k == 3;
      const Dropped one = drop(row.alpha, k_iterations[k], to_tolerance ? 1e-3f : 0.0f);
      EXPECT_NEAR(one.impact, row.impact[k], row.impact_room[k]) << row.alpha << ' ' << k_iterations[k];
      EXPECT_NEAR(one.rest, row.rest[k], row.rest_room[k]) << row.alpha << ' ' << k_iterations[k];
      EXPECT_GE(one.volume, 0.999) << row.alpha << ' ' << k_iterations[k];
      EXPECT_LE(one.iterations, to_tolerance ? row.most_iterations : k_iterations[k]) << row.alpha;
    }
  // What it cures.
  const Dropped none = drop(0.3f, 0, 0, 16.0f);
  EXPECT_NEAR(none.impact, 2.16, 0.05);
  EXPECT_NEAR(none.volume, 0.70, 0.03);
}

TEST(volume, is_kept_better_beside_the_pressure_that_a_step_can_carry) {
  for (const float alpha : {0.3f, 0.7f, 1.0f}) {
    const Dropped beside = drop(alpha, 1, 0, {});
    EXPECT_LT(beside.impact, 1.21) << alpha;
    EXPECT_LT(beside.rest, 1.05) << alpha;
    EXPECT_GT(beside.volume, 0.995) << alpha;
    EXPECT_GT(drop(alpha, 0, 0, {}).impact, 1.25) << alpha;
  }
}

/// A cube of 10³ between plates that take a fifth of its height in 100 steps and give it back.
struct Squeezed {
  double worst = 0;  ///< ρ/ρ0
  double bulge = 0;  ///< width over that before, when it is squeezed most
  double left = 0;   ///< mean distance from where particles were, at the end [h]
};
Squeezed squeeze(float alpha, int iterations, float tolerance = 0) {
  SolverConfig solver = config(iterations, tolerance);
  solver.gravity = {0, 0, 0};
  solver.wall_pressure = false;
  Simulation s(solver);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  const ColliderId top = s.add_collider({.shape = Plane{{0, 0, -1}, -10}, .friction = 0.3f});
  const BodyId id = s.add_body(sample(Lattice{.count = {10, 10, 10}, .jitter = 0}),
                               {.alpha = alpha, .update_threshold = 1e6f});
  Squeezed squeezed;
  const std::vector<Vec3> start = s.positions_by_id();
  const auto width = [&] {
    const std::span<const float> x = s.positions().x();
    return *std::ranges::max_element(x) - *std::ranges::min_element(x) + 1;
  };
  Poly6Densities densities(2.1, 1);
  constexpr int k_way = 100;
  for (int k = 0; k < 3 * k_way; ++k) {
    const float speed = k < k_way ? -2.0f : k < 2 * k_way ? 2.0f : 0.0f;
    s.set_twist(top, {0, 0, speed / (k_way * 0.15f)}, {0, 0, 0});
    s.step();
    squeezed.worst = std::max(squeezed.worst, densities.worst(s));
    if (k == k_way - 1) squeezed.bulge = static_cast<double>(width() / 10);
  }
  const Vec3 shift = (s.motion(id).center_of_mass - Vec(5, 5, 5)).cast<float>();
  const std::vector<Vec3> end = s.positions_by_id();
  for (std::size_t i = 0; i < end.size(); ++i)
    squeezed.left +=
        static_cast<double>((end[i] - start[i] - shift).norm()) / static_cast<double>(end.size());
  return squeezed;
}

TEST(volume, of_what_is_squeezed_goes_to_the_sides_and_comes_back) {
  for (const float alpha : {0.0f, 0.3f, 0.9f}) {
    const Squeezed all = squeeze(alpha, 50, 1e-3f), three = squeeze(alpha, 3);
    EXPECT_LT(all.worst, 1.025) << alpha;
    EXPECT_LT(three.worst, alpha < 0.1f ? 1.08 : 1.055) << alpha;
    // The widest row bulges by more than the 1.118 that keep all of it.
    EXPECT_NEAR(all.bulge, 1.16, 0.005) << alpha;
    EXPECT_LT(all.left, alpha < 0.5f ? 2e-4 : 0.025) << alpha;
    EXPECT_LT(three.left, alpha < 0.5f ? 2e-4 : 0.025) << alpha;
  }
}

/// Of all bodies, about the origin.
struct Moments {
  Vec momentum{0, 0, 0}, spin{0, 0, 0};
  double pace = 0, turns = 0;  ///< Σ m |v|, Σ m |x| |v|
};
Moments moments(const Simulation& s) {
  Moments sum;
  for (const BodyId id : s.bodies()) {
    const Simulation::Rows rows = s.rows(id);
    const double mass = s.motion(id).mass / static_cast<double>(rows.end - rows.begin);
    for (std::size_t row = rows.begin; row < rows.end; ++row) {
      const Vec x = s.positions()[row].cast<double>(), p = mass * s.velocities()[row].cast<double>();
      sum.momentum += p;
      sum.spin += x.cross(p);
      sum.pace += p.norm();
      sum.turns += x.norm() * p.norm();
    }
  }
  return sum;
}

TEST(volume, iterations_keep_momentum_of_bodies_that_hit_each_other) {
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    SolverConfig solver = config(2);
    solver.gravity = {0, 0, 0};
    Simulation s(solver);
    const Material heavy{.alpha = alpha, .particle_mass = 2.0f, .cohesion = 0.5f};
    Body one = sample(Lattice{.count = {6, 6, 6}, .jitter = 0.1f});
    one.velocity = {0.4f, 0.2f, 1};
    s.add_body(one, heavy);
    Body other = sample(Lattice{.count = {6, 6, 6}, .spacing = 0.9f, .corner = {1, 0.5f, 7}, .jitter = 0.1f});
    other.velocity = {0, 0, -1};
    s.add_body(other, Material{.alpha = alpha});
    s.prepare();
    const Moments before = moments(s);
    int taken = 0;
    for (int k = 0; k < 1000; ++k) taken += s.step().volume_iterations;
    EXPECT_GT(taken, 100) << alpha;
    EXPECT_LT((moments(s).momentum - before.momentum).norm(), 1e-6 * before.pace) << alpha;
  }
}

// Of one body: the normals and the friction of contact between two know nothing of spin.
TEST(volume, iterations_keep_momentum_and_spin_of_a_body_that_is_pressed_while_it_turns) {
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    SolverConfig solver = config(2);
    solver.gravity = {0, 0, 0};
    Simulation s(solver);
    Body body = sample(Lattice{.count = {8, 8, 8}, .corner = {-4, -4, -4}, .jitter = 0.1f});
    for (const Vec3& x : body.positions)
      body.velocities.push_back(Vec3(0.01f, 0.02f, 0) + Vec3(0.02f, 0, 0.05f).cross(x) - 0.1f * x);
    s.add_body(body, Material{.alpha = alpha, .update_threshold = 1e6f, .deformation_damping = 0.0f});
    s.prepare();
    const Moments before = moments(s);
    int taken = 0;
    for (int k = 0; k < 1000; ++k) taken += s.step().volume_iterations;
    const Moments after = moments(s);
    EXPECT_GT(taken, alpha < 1 ? 1000 : 30) << alpha;  // a fluid is pressed once
    EXPECT_LT((after.momentum - before.momentum).norm(), 1e-6 * before.pace) << alpha;
    EXPECT_LT((after.spin - before.spin).norm(), 1e-5 * before.turns) << alpha;
  }
}

/// Distance of each particle to the one that is nearest, ascending.
std::vector<float> nearest_distances(const Simulation& s) {
  const std::vector<Vec3> x = s.positions_by_id();
  std::vector<float> nearest;
  for (std::size_t i = 0; i < x.size(); ++i) {
    float least = std::numeric_limits<float>::max();
    for (std::size_t j = 0; j < x.size(); ++j)
      if (j != i) least = std::min(least, (x[i] - x[j]).squaredNorm());
    nearest.push_back(std::sqrt(least));
  }
  std::ranges::sort(nearest);
  return nearest;
}

// With the kernel of densities half of the pool was within 0.16 spacings of another particle after 8
// iterations a step, and a tenth of the paste within 0.3.
TEST(volume, iterations_keep_the_particles_of_what_flows_apart_however_many_they_are) {
  const Material pool{.alpha = 1.0f};
  Material paste{.alpha = 0.7f, .youngs_modulus = 2.0f, .damping_time = 0.05f};
  paste.plastic_yield = 0.1f;
  paste.plastic_creep = 1.0f;
  for (const Material& material : {pool, paste})
    for (const int iterations : {1, 2, 8}) {
      Simulation s(config(iterations));
      s.add_collider({.shape = Box{{-7.5, -5, 0}, {7.5, 5, 99}, true}, .friction = 0.3f});
      s.add_body(sample(Lattice{.count = {10, 10, 12}, .corner = {-7.5, -5, 0.5}, .jitter = 0.1f}), material);
      s.advance(400 * 0.15);
      const std::vector<float> nearest = nearest_distances(s);
      EXPECT_GT(nearest[nearest.size() / 2], 0.75f) << iterations;
      EXPECT_GT(nearest[nearest.size() / 100], 0.5f) << iterations;
    }
}

TEST(volume, of_a_poured_pool_is_kept_with_the_share_of_walls) {
  for (const float alpha : {1.0f, 0.7f})
    for (const int iterations : {1, 2}) {
      Simulation s(config(iterations));
      s.add_collider({.shape = Box{{-5, -5, 0}, {5, 5, 99}, true}, .friction = 0.3f});
      s.add_body(sample(Lattice{.count = {10, 10, 12}, .corner = {-5, -5, 4}, .jitter = 0.1f}),
                 {.alpha = alpha});
      s.advance(600 * 0.15);
      const std::span<const float> z = s.positions().z();
      const double depth = 2 * std::accumulate(z.begin(), z.end(), 0.0) / static_cast<double>(z.size());
      EXPECT_GT(depth, 0.95 * 12) << alpha << ' ' << iterations;
      EXPECT_LT(depth, 1.035 * 12) << alpha << ' ' << iterations;
      EXPECT_LT(s.energy().kinetic, 1e-3 * 1200 * 0.3 * 4) << alpha << ' ' << iterations;
    }
}

TEST(volume, pushes_are_in_the_loads_of_colliders) {
  Simulation s(config(2));
  const ColliderId tank =
      s.add_collider({.shape = Box{{-4, -4, 0}, {4, 4, 99}, true}, .friction = 0.3f, .measure_load = true});
  const BodyId id =
      s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {-4, -4, 1}, .jitter = 0.1f}), {.alpha = 1.0f});
  for (int k = 0; k < 60; ++k) {
    const Vec before = s.motion(id).momentum;
    const double seconds = s.step().time_step;
    const Vec weight = s.motion(id).mass * seconds * Vec(0, 0, -static_cast<double>(0.3f));
    EXPECT_NEAR((s.motion(id).momentum - before + s.load(tank).impulse - weight).norm(), 0, 1e-3) << k;
  }
}

/// All at once: a fluid, a jelly and a paste that touch, some of it pinned, in a tank.
Simulation mixed(int iterations, int threads, InstructionLevel level) {
  SolverConfig solver = config(iterations);
  solver.threads = threads;
  solver.instruction_level = level;
  Simulation s(solver);
  s.add_collider({.shape = Box{{0, 0, 0}, {8, 8, 99}, true}, .friction = 0.3f});
  s.add_collider({.shape = Sphere{{4, 4, -1}, 3}, .angular_velocity = {0.1f, 0.2f, 0}});
  s.add_body(sample(Lattice{.count = {8, 8, 4}, .corner = {0, 0, 2}, .jitter = 0.1f}),
             {.alpha = 1.0f, .rest_density = 2.0f});
  s.add_body(sample(Lattice{.count = {5, 5, 5}, .spacing = 0.9f, .corner = {1, 1, 7}, .jitter = 0.1f}),
             {.alpha = 0.0f});
  s.add_body(sample(Lattice{.count = {5, 5, 5}, .corner = {2, 2, 13}, .jitter = 0.1f}),
             {.alpha = 0.7f, .cohesion = 0.5f});
  s.pin(Aabb{{0, 0, 7}, {8, 2, 9}}, {0, 0, -0.1f});
  return s;
}

TEST(volume, gives_the_same_bits_for_any_number_of_threads_and_level_and_after_a_restore) {
  const auto hash = [](int threads, InstructionLevel level) {
    Simulation s = mixed(2, threads, level);
    for (int k = 0; k < 60; ++k) s.step();
    return s.state_hash();
  };
  const std::uint64_t one = hash(1, best_instruction_level());
  EXPECT_EQ(hash(2, best_instruction_level()), one);
  EXPECT_EQ(hash(3, best_instruction_level()), one);
  EXPECT_EQ(hash(2, InstructionLevel::baseline), one);
  Simulation s = mixed(2, 2, best_instruction_level());
  for (int k = 0; k < 30; ++k) s.step();
  Simulation restored = Simulation::restore(s.save(), 1);
  for (int k = 0; k < 30; ++k) restored.step();
  EXPECT_EQ(restored.state_hash(), one);
}

TEST(volume, is_kept_where_bodies_of_different_matter_touch_and_are_pinned) {
  Simulation s = mixed(3, 2, best_instruction_level());
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    s.step();
    worst = std::max(worst, worst_density(s));
  }
  EXPECT_LT(worst, 1.4);
  EXPECT_LT(worst_density(s), 1.1);
}

TEST(volume, is_the_same_far_from_the_origin_and_in_other_units) {
  const auto worst = [](float scale, float far) {
    SolverConfig solver = config(2);
    solver.support_radius = *solver.support_radius * scale;
    solver.gravity *= scale;
    Simulation s(solver);
    s.add_collider({.shape = Plane{}, .friction = 0.3f});
    Body cube = sample(
        Lattice{.count = {8, 8, 8}, .spacing = scale, .corner = {far * scale, 0, 6 * scale}, .jitter = 0});
    s.add_body(cube, {.alpha = 0.3f, .particle_mass = 1 / scale});
    double most = 0;
    for (int k = 0; k < 120; ++k) {
      s.step();
      most = std::max(most, worst_density(s));
    }
    return most;
  };
  const double here = worst(1, 0);
  EXPECT_NEAR(worst(1e-4f, 0), here, 1e-3);
  EXPECT_NEAR(worst(1e4f, 0), here, 1e-3);
  EXPECT_NEAR(worst(1, 1e5f), here, 0.02);
}

TEST(volume, iterations_end_at_the_tolerance_and_are_none_where_nothing_is_pressed) {
  SolverConfig solver = config(50, 1e-3f);
  Simulation s(solver);
  s.add_collider({.shape = Plane{}});
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {0, 0, 4}, .jitter = 0}), {.alpha = 0.0f});
  for (int k = 0; k < 10; ++k) EXPECT_LE(s.step().volume_iterations, 1) << k;  // it falls
  int most = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = s.step();
    most = std::max(most, report.volume_iterations);
    EXPECT_TRUE(report.mean_compression <= 1e-3 || report.volume_iterations == 50) << k;
    EXPECT_GE(report.largest_compression, report.mean_compression) << k;
  }
  EXPECT_GT(most, 3);
}

TEST(volume, iterations_are_two_where_a_body_flows_unless_they_are_given) {
  const auto iterations = [](std::optional<float> yield, std::optional<int> given) {
    Simulation s({.volume_iterations = given});
    s.add_body(sample(Lattice{.count = {4, 4, 4}}), {.plastic_yield = yield});
    const int most = s.info().volume_iterations;
    s.add_collider({.shape = Plane{.offset = 0.6f}});  // what is pressed takes all of them
    EXPECT_EQ(s.step().volume_iterations, most);
    return most;
  };
  EXPECT_EQ(iterations(0.1f, {}), 2);
  EXPECT_EQ(iterations({}, {}), 0);
  EXPECT_EQ(iterations(0.1f, 0), 0);
  EXPECT_EQ(iterations(0.1f, 3), 3);
  EXPECT_EQ(iterations({}, 1), 1);
  Simulation later({});  // what comes later asks for them too, and what goes no more
  later.add_body(sample(Lattice{.count = {4, 4, 4}}), Material{});
  EXPECT_EQ(later.info().volume_iterations, 0);
  const BodyId paste =
      later.add_body(sample(Lattice{.count = {4, 4, 4}, .corner = {0, 0, 20}}), {.plastic_yield = 0.1f});
  later.step();
  EXPECT_EQ(later.info().volume_iterations, 2);
  later.remove_body(paste);
  EXPECT_EQ(later.info().volume_iterations, 0);
}

TEST(volume, warns_of_a_tolerance_of_nothing_and_of_bodies_too_stiff_for_it) {
  const auto warnings = [](const SolverConfig& solver, float elastic_time_step) {
    Simulation s(solver);
    s.add_body(sample(Lattice{.count = {4, 4, 4}, .jitter = 0}),
               {.alpha = 0.0f, .elastic_time_step = elastic_time_step});
    std::string all;
    for (const std::string& one : s.info().warnings) all += one + '\n';
    return all;
  };
  EXPECT_NE(warnings(config(0, 1e-3f), 0.15f).find("volume_tolerance"), std::string::npos);
  EXPECT_NE(warnings(config(2), 0.06f).find("raise material.elastic_time_step"), std::string::npos);
  EXPECT_EQ(warnings(config(2, 1e-3f), 0.15f), "");
}

TEST(volume, costs_nothing_where_it_is_off) {
  const auto run = [](SolverConfig solver) {
    Simulation s(solver);
    s.add_body(sample(Lattice{.count = {6, 6, 6}, .jitter = 0.1f}), {.alpha = 0.0f});
    s.step();
    EXPECT_TRUE(s.densities().empty());
    return s.info().bytes;
  };
  EXPECT_EQ(run(config(0)), run(config(0, 0.5f)));
}

TEST(volume, lets_what_rests_fall_asleep_and_wakes_what_is_hit) {
  SolverConfig solver = config(2);
  solver.sleep_speed = {};
  Simulation s(solver);
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  for (const float z : {0.0f, 7.0f})
    s.add_body(sample(Lattice{.count = {6, 6, 6}, .corner = {0, 0, z}, .jitter = 0.05f}), {.alpha = 0.0f});
  StepReport report;
  for (int k = 0; k < 3000; ++k) {
    report = s.step();
    if (report.awake_bodies == 0) break;
  }
  EXPECT_EQ(report.awake_bodies, 0u);
  Body ball = sample(Lattice{.count = {3, 3, 3}, .corner = {1, 1, 16}, .jitter = 0});
  s.add_body(ball, Material{.alpha = 0.0f});
  std::size_t awake = 0;
  for (int k = 0; k < 120; ++k) awake = std::max(awake, s.step().awake_bodies);
  EXPECT_EQ(awake, 3u);
}

// With the whole share at 4 spacings and more a body at rest threw itself about, at up to 28 m/s in metres.
TEST(volume, leaves_what_rests_at_rest_whatever_the_support_radius) {
  for (const float radius : {2.1f, 3.0f, 3.5f, 4.0f, 4.5f, 5.0f, 6.3f}) {
    SolverConfig solver = config(2);
    solver.support_radius = radius;
    Simulation s(solver);
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    Material material{.alpha = 0.3f, .update_threshold = 1e6f};
    material.region_radius = 2.1f;
    s.add_body(sample(Lattice{.count = {8, 8, 8}, .jitter = 0.2f}), material);
    for (int k = 0; k < 600; ++k) s.step();
    float fastest = 0;
    for (const Vec3& v : s.velocities_by_id()) fastest = std::max(fastest, v.norm());
    EXPECT_LT(fastest, 1e-3f) << radius;
  }
}

}  // namespace volume_test
}  // namespace mallow

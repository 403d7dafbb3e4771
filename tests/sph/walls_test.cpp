// What colliders hold of the volume around fluids: wall_pressure.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include "mallow/mallow.h"
#include "sph/walls.h"

namespace mallow {
namespace walls_test {

using Vec = Eigen::Vector3d;

constexpr float k_gravity = 0.3f;
const Vec k_down(0, 0, -static_cast<double>(k_gravity));

SolverConfig config(bool wall_pressure = true, int threads = 2) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, -k_gravity},
          .wall_pressure = wall_pressure,
          .sleep_speed = 0.0f,
          .threads = threads};
}

/// ∫ from d to σ of f, by shells: the plane cuts a cap off each sphere that is larger.
double beyond(double d, double sigma, const std::function<double(double)>& f) {
  constexpr int k_shells = 20000;
  double sum = 0;
  for (int k = 0; k < k_shells; ++k) {
    const double r = d + (sigma - d) * (k + 0.5) / k_shells;
    sum += f(r) * (sigma - d) / k_shells;
  }
  return sum;
}

TEST(half_space, holds_the_integrals_of_the_kernels_beyond_its_plane) {
  const double sigma = 1.7, pi = std::numbers::pi;
  for (const double q : {0.0, 0.1, 0.25, 0.5, 0.8, 0.99}) {
    const double d = q * sigma;
    const double share = beyond(d, sigma, [&](double r) {
      const double w = 315 / (64 * pi * std::pow(sigma, 9)) * std::pow(sigma * sigma - r * r, 3);
      return 2 * pi * r * (r - d) * w;  // the cap's area
    });
    const double gradient = beyond(d, sigma, [&](double r) {
      const double slope = 45 / (pi * std::pow(sigma, 6)) * std::pow(sigma - r, 2);
      return pi * (r * r - d * d) * slope;  // its shadow
    });
    const auto at = static_cast<float>(q);
    EXPECT_NEAR(static_cast<double>(half_space_share(DensityKernel::poly6, at)), share, 1e-6) << q;
    EXPECT_NEAR(static_cast<double>(half_space_gradient(at)), sigma * gradient, 1e-6) << q;
    const auto wendland = [&](double r) {
      return 21 / (2 * pi * std::pow(sigma, 3)) * std::pow(1 - r / sigma, 4) * (1 + 4 * r / sigma);
    };
    const double of_other = beyond(d, sigma, [&](double r) { return 2 * pi * r * (r - d) * wendland(r); });
    const double slope = beyond(d, sigma, [&](double r) { return 2 * pi * r * wendland(r); });
    EXPECT_NEAR(static_cast<double>(half_space_share(DensityKernel::wendland, at)), of_other, 1e-6) << q;
    EXPECT_NEAR(static_cast<double>(wendland_half_space_slope(at)), sigma * slope, 1e-6) << q;
  }
}

/// One particle at the origin, h 1, and S and the sum of B n of the walls around it.
struct Seen {
  float share = 0;
  Vec3 gradient{0, 0, 0};
};
Seen seen_from_origin(const std::vector<Collider>& colliders, float sigma = 2.0f) {
  VectorColumn x(1);
  std::vector<PlacedCollider> placed;
  place_colliders(colliders, {0, 0, 0}, 0.1f, best_instruction_level(), placed);
  const SphGroup group{};
  Walls walls;
  walls.bodies = {{.begin = 0, .end = 1, .reach = sigma, .alpha = 1, .mass = 1, .group = &group}};
  const Execution execution{1, best_instruction_level()};
  find_walls(x, x, placed, DensityKernel::poly6, sigma, execution, walls);
  if (!walls.any) return {};
  Seen seen{walls.share[0]};
  for (const Walls::Wall& wall : walls.walls[0]) seen.gradient += wall.gradient * wall.normal;
  return seen;
}

TEST(walls, every_shape_is_the_half_space_behind_its_nearest_plane_however_it_is_turned) {
  const float d = 0.7f, r = 3;
  const Vec3 corners[] = {{-3, -3, -d}, {3, -3, -d}, {0, 3, -d}, {0, 0, -4}};
  const std::vector<Primitive> below = {Plane{{0, 0, 1}, -d},
                                        Sphere{{0, 0, -r - d}, r},
                                        Sphere{{0, 0, r - d}, r, true},
                                        Box{{-9, -9, -9}, {9, 9, -d}},
                                        Box{{-9, -9, -d}, {9, 9, 9}, true},
                                        Capsule{{-3, 0, -r - d}, {3, 0, -r - d}, r},
                                        Cylinder{{0, 0, -9}, {0, 0, -d}, 5},
                                        Cylinder{{0, 0, -d}, {0, 0, 9}, 5, true},
                                        Cone{{0, 0, -9}, {0, 0, -d}, 5, 5.5f},
                                        convex_hull(corners)};
  for (std::size_t k = 0; k < below.size(); ++k) {
    std::visit(
        [&](const auto& shape) {
          Collider collider{.shape = shape};
          for (const double angle : {0.0, 0.8}) {
            const Eigen::AngleAxisd turn(angle, Vec(1, 2, 0.5).normalized());
            collider.pose.rotation = Eigen::Quaterniond(turn).coeffs();
            const Seen seen = seen_from_origin({collider});
            EXPECT_NEAR(seen.share, half_space_share(DensityKernel::poly6, d / 2), 1e-5f) << k;
            const Vec up = turn * Vec::UnitZ();
            EXPECT_NEAR((seen.gradient.cast<double>() - half_space_gradient(d / 2) / 2.0 * up).norm(), 0,
                        1e-5)
                << k;
          }
        },
        below[k]);
  }
}

TEST(walls, what_two_of_them_cover_counts_once) {
  const float d = 0.6f, s = half_space_share(DensityKernel::poly6, d / 2), b = half_space_gradient(d / 2) / 2;
  const Collider floor{.shape = Plane{{0, 0, 1}, -d}}, wall{.shape = Plane{{1, 0, 0}, -d}};
  // A floor of two tiles, one under the other, or side by side with the particle above the joint.
  for (const Seen& seen :
       {seen_from_origin({floor, floor}), seen_from_origin({floor, {.shape = Plane{{0, 0, 1}, -1.5f}}}),
        seen_from_origin(
            {{.shape = Box{{-9, -9, -9}, {0, 9, -d}}}, {.shape = Box{{0, -9, -9}, {9, 9, -d}}}})}) {
    EXPECT_NEAR(seen.share, s, 1e-6f);
    EXPECT_NEAR((seen.gradient - Vec3(0, 0, b)).norm(), 0, 1e-6f);
  }
  // In an edge each wall stands on what the other leaves free.
  const Seen edge = seen_from_origin({floor, wall});
  EXPECT_NEAR(edge.share, 1 - (1 - s) * (1 - s), 1e-6f);
  EXPECT_NEAR((edge.gradient - (1 - s) * b * Vec3(1, 0, 1)).norm(), 0, 1e-6f);
  // Between two that look at each other both count, and their pushes cancel.
  const Seen gap = seen_from_origin({floor, {.shape = Plane{{0, 0, -1}, -d}}});
  EXPECT_NEAR(gap.share, 2 * s, 1e-6f);
  EXPECT_NEAR(gap.gradient.norm(), 0, 1e-6f);
}

TEST(walls, are_nothing_to_what_is_farther_than_a_support_radius) {
  EXPECT_EQ(seen_from_origin({{.shape = Plane{{0, 0, 1}, -2.01f}}}).share, 0);
  EXPECT_GT(seen_from_origin({{.shape = Plane{{0, 0, 1}, -1.9f}}}).share, 0);
}

struct Pool {
  Simulation simulation;
  ColliderId tank{};
  BodyId body{};
};
/// Water of n × n × layers particles in a tank that it fills, `drop` above its ground.
Pool pool(const SolverConfig& solver, int n, int layers, float alpha, float drop, float friction = 0.3f) {
  Pool pool{Simulation(solver)};
  const float half = 0.5f * static_cast<float>(n);
  pool.tank = pool.simulation.add_collider(
      {.shape = Box{{-half, -half, 0}, {half, half, 99}, true}, .friction = friction, .measure_load = true});
  pool.body = pool.simulation.add_body(
      sample(Lattice{.count = {n, n, layers}, .corner = {-half, -half, drop}, .jitter = 0.1f}),
      {.alpha = alpha});
  return pool;
}
double depth(const Pool& pool) {
  const std::span<const float> z = pool.simulation.positions().z();
  return 2 * std::accumulate(z.begin(), z.end(), 0.0) / static_cast<double>(z.size());
}

TEST(wall_pressure, lets_a_poured_pool_rest_as_deep_as_its_volume_is) {
  for (const float alpha : {1.0f, 0.7f}) {
    Pool poured = pool(config(), 10, 12, alpha, 4);
    poured.simulation.advance(600 * 0.15);
    EXPECT_GT(depth(poured), 0.95 * 12) << alpha;
    EXPECT_LT(depth(poured), 1.01 * 12) << alpha;
    // Of what it fell with: the calm of a pool, not of a gas.
    EXPECT_LT(poured.simulation.energy().kinetic, 1e-3 * 1200 * 0.3 * 4) << alpha;
  }
  Pool without = pool(config(false), 10, 12, 1, 4);
  without.simulation.advance(600 * 0.15);
  EXPECT_LT(depth(without), 0.9 * 12);
}

TEST(wall_pressure, calms_a_pool_between_walls_without_friction) {
  Pool smooth = pool(config(), 10, 10, 1, 0, 0);
  smooth.simulation.advance(400 * 0.15);
  EXPECT_LT(smooth.simulation.energy().kinetic, 1e-3 * 1000 * 0.3);
}

TEST(wall_pressure, is_in_the_loads_of_colliders_with_its_moment) {
  Pool tilted = pool(config(), 8, 8, 1, 1);
  Simulation& s = tilted.simulation;
  Collider ball{.shape = Sphere{{0, 0, 0}, 2}, .friction = 0.3f, .measure_load = true};
  ball.pose.translation = {0.5, 0, 2};
  const ColliderId id = s.add_collider(ball);
  s.set_twist(id, {0.05f, 0.02f, 0}, {0.1f, 0.2f, 0});
  struct Momenta {
    Vec linear{0, 0, 0}, angular{0, 0, 0}, weight_moment{0, 0, 0};
  };
  const auto momenta = [&] {
    Momenta sum;
    for (std::size_t i = 0; i < s.particle_count(); ++i) {
      const Vec x = s.positions()[i].cast<double>(), v = s.velocities()[i].cast<double>();
      sum.linear += v;
      sum.angular += x.cross(v);
      sum.weight_moment += x.cross(k_down);
    }
    return sum;
  };
  double most = 0;
  for (int k = 0; k < 60; ++k) {
    const Momenta before = momenta();
    const Vec center = s.collider(id).pose.translation;
    const double seconds = s.step().time_step;
    const Momenta after = momenta();
    const ColliderLoad to_tank = s.load(tilted.tank), to_ball = s.load(id);
    const Vec given = to_tank.impulse + to_ball.impulse;
    const Vec turned = to_tank.torque + to_ball.torque + center.cross(to_ball.impulse);
    const double mass = static_cast<double>(s.particle_count());
    EXPECT_NEAR((after.linear - before.linear + given - mass * seconds * k_down).norm(), 0, 1e-3) << k;
    EXPECT_NEAR((after.angular - before.angular + turned - seconds * before.weight_moment).norm(), 0, 5e-3)
        << k;
    most = std::max(most, to_ball.torque.norm());
  }
  EXPECT_GT(most, 0.1);
}

TEST(wall_pressure, lets_a_block_float_as_deep_as_archimedes_says) {
  constexpr int k_side = 20, k_layers = 12;
  Pool pond = pool(config(), k_side, k_layers, 1, 0);
  Simulation& s = pond.simulation;
  const Vec half(5, 5, 5);
  const double mass = 0.5 * 8 * half.prod();
  Collider block{
      .shape = Box{(-half).cast<float>(), half.cast<float>()}, .friction = 0.3f, .measure_load = true};
  block.pose.translation = {0, 0, k_layers + half.z() + 0.2};
  const ColliderId id = s.add_collider(block);
  Vec velocity(0, 0, 0), spin(0, 0, 0);
  double bottom = 0;
  constexpr int k_steps = 500, k_mean = 150;
  for (int k = 0; k < k_steps; ++k) {
    s.set_twist(id, velocity.cast<float>(), spin.cast<float>());
    const StepReport report = s.step();
    const ColliderLoad load = s.load(id);
    const Eigen::Quaterniond turn(Eigen::Vector4d(s.collider(id).pose.rotation));
    const Vec squares = half.cwiseAbs2(), inertia = mass / 3 * (Vec::Constant(squares.sum()) - squares);
    velocity += load.impulse / mass + report.time_step * k_down;
    spin += turn * (turn.conjugate() * load.torque).cwiseQuotient(inertia);
    if (k >= k_steps - k_mean) bottom += (s.collider(id).pose.translation.z() - half.z()) / k_mean;
  }
  // It displaces its weight, which raises the level.
  const double level = k_layers + mass / (k_side * k_side), draft = half.z();
  EXPECT_NEAR(level - bottom, draft, 0.05 * draft);
  EXPECT_LT(velocity.norm(), 0.05);
}

/// A soft block on a floor under gravity that is tilted by 30 degrees, friction 0.3.
Simulation sliding_block(SolverConfig solver, float alpha, const Vec3& belt = {0, 0, 0}, bool tilted = true) {
  solver.gravity = tilted ? Vec3(0.5f * k_gravity, 0, -0.866f * k_gravity) : Vec3(0, 0, -k_gravity);
  Simulation s(solver);
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {0, 0, 0.5f}, .jitter = 0.1f}), {.alpha = alpha});
  Collider floor{.shape = Plane{}, .friction = 0.3f, .measure_load = true};
  floor.surface_velocity = belt;
  s.add_collider(floor);
  return s;
}
double mean_velocity(const Simulation& s) {
  return s.velocities().eigen().col(0).cast<double>().mean();
}

// A solid's stresses along a floor have a sum that is not 0: mirrored whole, they drove it at some spacings a
// second.
TEST(wall_pressure, drives_no_solid_along_a_floor_without_friction) {
  for (const float alpha : {0.1f, 0.4f, 0.7f}) {
    SolverConfig solver = config();
    solver.sleep_speed = 0.0f;
    Simulation s(solver);
    s.add_collider({.shape = Plane{}});
    const BodyId body = s.add_body(sample(Lattice{.count = {8, 8, 6}, .jitter = 0.2f}),
                                   {.alpha = alpha, .update_threshold = 1e6f});
    const Eigen::Vector3d start = s.motion(body).center_of_mass;
    s.advance(150);
    EXPECT_LT((s.motion(body).center_of_mass - start).head<2>().norm(), 0.05) << alpha;
  }
}

TEST(wall_pressure, lets_a_soft_block_slide_down_a_slope_as_coulomb_says) {
  const double slides = static_cast<double>(k_gravity) * (0.5 - 0.3 * 0.866);
  for (const int iterations : {0, 1})
    for (const float alpha : {0.1f, 0.4f, 0.7f}) {
      SolverConfig solver = config();
      solver.volume_iterations = iterations;
      Simulation s = sliding_block(solver, alpha);
      s.advance(15);
      const double before = mean_velocity(s), from = s.time();
      s.advance(30);
      EXPECT_NEAR((mean_velocity(s) - before) / (s.time() - from), slides, 0.06 * slides)
          << alpha << ' ' << iterations;
    }
}

TEST(wall_pressure, rubs_as_much_in_shorter_steps) {
  const auto slid = [](float time_step) {
    SolverConfig solver = config();
    solver.time_step = time_step;
    Simulation s = sliding_block(solver, 0.4f);
    s.advance(45);
    return mean_velocity(s);
  };
  EXPECT_NEAR(slid(0.075f), slid(0.15f), 0.03 * slid(0.15f));
}

TEST(wall_pressure, lets_a_belt_carry_a_soft_block_and_feel_as_much) {
  SolverConfig solver = config();
  solver.volume_iterations = 1;
  Simulation s = sliding_block(solver, 0.4f, {-50, 0, 0}, false);
  double given = 0;
  for (int k = 0; k < 200; ++k) {
    s.step();
    given += s.load(ColliderId{0}).impulse.x();
  }
  const double momentum = 512 * mean_velocity(s);
  EXPECT_NEAR(given + momentum, 0, 1e-4 * std::abs(momentum));
  EXPECT_NEAR(momentum, -512 * 0.3 * static_cast<double>(k_gravity) * s.time(), 0.08 * std::abs(momentum));
}

/// A particle of a fluid that slides at 0.5 h/s on a floor with friction, for a second; what is left, and
/// what the floor got along.
std::pair<double, double> slid_on(float viscosity, float adhesion, float time_step) {
  SolverConfig of_it = config();
  of_it.time_step = time_step;
  Simulation s(of_it);
  const MaterialId fluid =
      s.add_material({.alpha = 1, .viscosity = viscosity, .particle_mass = 2, .adhesion = adhesion});
  s.add_body({.positions = {{0, 0, 0.5f}}, .spacing = 1, .velocity = {0.5f, 0, 0}}, fluid);
  const ColliderId floor =
      s.add_collider({.shape = Plane{{0, 0, 1}, 0}, .friction = 0.5f, .measure_load = true});
  double given = 0;
  while (s.time() < 1) {
    s.step_towards(1);
    given += static_cast<double>(s.load(floor).impulse.x());
  }
  return {static_cast<double>(s.velocities()[0].x()), given};
}

// The stress is μ v/(h/2) on an area of h², so that a mass of 2 slows at a rate of μ.
TEST(wall_hold, slows_what_sticks_by_its_viscosity_and_not_by_friction_at_any_step) {
  for (const float step : {0.15f, 0.05f}) {
    for (const float viscosity : {0.25f, 1.0f}) {
      const auto [left, given] = slid_on(viscosity, 100, step);
      EXPECT_NEAR(left, 0.5 * std::exp(-static_cast<double>(viscosity)), 1e-4) << viscosity << ' ' << step;
      EXPECT_NEAR(given, 2 * (0.5 - left), 1e-4) << "the floor gets it";
    }
    EXPECT_NEAR(slid_on(100, 0.3f, step).first, 0.5 - 0.3 / 2, 1e-4) << "no more than adhesion";
    EXPECT_NEAR(slid_on(0.25f, 0, step).first, 0.5 - 0.5 * 0.3, 1e-4) << "Coulomb's friction";
  }
}

TEST(wall_pressure, gives_the_same_bits_for_any_number_of_threads_and_level) {
  const auto hash = [](int threads, InstructionLevel level) {
    SolverConfig solver = config(true, threads);
    solver.instruction_level = level;
    Pool poured = pool(solver, 9, 9, 0.8f, 1);
    poured.simulation.add_collider({.shape = Sphere{{1, 0, 0}, 3}, .angular_velocity = {0.1f, 0.2f, 0}});
    for (int k = 0; k < 40; ++k) poured.simulation.step();
    return poured.simulation.state_hash();
  };
  const std::uint64_t one = hash(1, best_instruction_level());
  EXPECT_EQ(hash(2, best_instruction_level()), one);
  EXPECT_EQ(hash(3, best_instruction_level()), one);
  EXPECT_EQ(hash(2, InstructionLevel::baseline), one);
}

TEST(wall_pressure, costs_nothing_where_there_is_no_fluid_or_no_wall_or_none_is_near) {
  struct Result {
    std::uint64_t hash;
    std::size_t bytes;
  };
  const auto run = [](bool on, float alpha, bool collides, float height) {
    Simulation s(config(on));
    s.add_body(sample(Lattice{.count = {6, 6, 6}, .corner = {0, 0, height}, .jitter = 0.1f}),
               {.alpha = alpha});
    if (collides) s.add_collider({.shape = Plane{}});
    for (int k = 0; k < 20; ++k) s.step();
    return Result{s.state_hash(), s.info().bytes};
  };
  for (const auto& [alpha, collides, height] :
       {std::tuple{0.0f, true, 0.0f}, std::tuple{1.0f, false, 0.0f}, std::tuple{0.7f, true, 50.0f}}) {
    const Result with = run(true, alpha, collides, height), without = run(false, alpha, collides, height);
    EXPECT_EQ(with.hash, without.hash) << alpha;
    EXPECT_EQ(with.bytes, without.bytes) << alpha;
  }
  EXPECT_NE(run(true, 1, true, 0).hash, run(false, 1, true, 0).hash);
}

}  // namespace walls_test
}  // namespace mallow

#include "oracle/oracle.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "oracle/points.h"
#include "oracle/signed_distance.h"
#include "paper_settings.h"

namespace mallow::oracle {
namespace oracle_test {

std::vector<Vec> widened(const std::vector<Vec3>& points) {
  std::vector<Vec> wide;
  for (const Vec3& p : points) wide.push_back(p.cast<double>());
  return wide;
}

std::vector<Vec> blob(std::array<int, 3> count, float jitter, const Vec3& center = {0, 0, 0}) {
  return widened(lattice_points(count, 1.0f, center, jitter));
}

/// Velocities without any symmetry.
std::vector<Vec> shaken(std::size_t n, double size) {
  std::vector<Vec> velocities;
  for (std::size_t i = 0; i < n; ++i) {
    const auto s = static_cast<double>(i);
    velocities.push_back(size * Vec(std::sin(3 * s), std::cos(5 * s), std::sin(7 * s + 1)));
  }
  return velocities;
}

void add(Oracle& oracle, const Material& material, const std::vector<Vec>& positions,
         const Vec& velocity = {0, 0, 0}) {
  oracle.add_body(positions, std::vector<Vec>(positions.size(), velocity), 1.0,
                  oracle.add_group(with_paper_settings(material)));
}

SolverConfig weightless(float support_radius = 2.2f) {
  return with_paper_settings(
      SolverConfig{.support_radius = support_radius, .gravity = {0, 0, 0}, .contact = BodyContact::pressure});
}

/// One particle, alone, on its way to an obstacle.
Particle after_one_step(const Collider& collider, const Vec& x, const Vec& v, float contact_offset = 0.5f) {
  SolverConfig config = weightless();
  config.contact_offset = contact_offset;
  Oracle oracle(config);
  add(oracle, {}, {x}, v);
  oracle.add_collider(collider);
  oracle.step();
  return oracle.particles().front();
}

double average_region(std::array<int, 3> count, float spacing, float radius) {
  Oracle oracle(weightless(radius));
  oracle.add_body(widened(lattice_points(count, spacing)),
                  std::vector<Vec>(lattice_points(count, spacing).size()), spacing, oracle.add_group({}));
  double sum = 0;
  for (const Particle& p : oracle.particles()) sum += static_cast<double>(p.region.size());
  return sum / static_cast<double>(oracle.particles().size());
}

TEST(oracle, regions_have_the_averages_of_table_1) {
  EXPECT_NEAR(average_region({10, 10, 36}, 40.0f / 36, 8), 755.32, 0.005);
  EXPECT_NEAR(average_region({10, 10, 36}, 40.0f / 36, 5), 256.54, 0.005);
  EXPECT_NEAR(average_region({10, 10, 36}, 40.0f / 36, 3), 64.28, 0.005);
  EXPECT_NEAR(average_region({22, 22, 22}, 1, 2.9f), 80.70, 0.005);
  EXPECT_NEAR(average_region({15, 15, 15}, 22.0f / 15, 2.9f), 23.56, 0.005);
}

TEST(oracle, free_fall_equals_the_recurrence) {
  for (const float alpha : {0.0f, 0.4f, 1.0f}) {
    SolverConfig config{.support_radius = 2.2f, .gravity = {0.1f, 0, -0.4f}, .acoustic_limit = false};
    Oracle oracle(config);
    Material material{.alpha = alpha};
    material.pressure_coefficient = 0;  // a lattice that is not at rest pressure would swell as it falls
    const std::vector<Vec> start = blob({3, 3, 3}, 0.2f);
    add(oracle, material, start, {0.3, 0, 1});
    Vec v(0.3, 0, 1), moved(0, 0, 0);
    for (int c = 0; c < 40; ++c) {
      const double dt = oracle.step().time_step;
      v += dt * config.gravity.cast<double>();
      moved += dt * v;
    }
    for (std::size_t i = 0; i < start.size(); ++i) {
      EXPECT_LT((oracle.particles()[i].x - start[i] - moved).norm(), 1e-12) << "alpha " << alpha;
    }
  }
}

TEST(oracle, rigid_motion_of_the_reference_gives_goal_equal_position) {
  const std::vector<std::vector<Vec>> bodies = {blob({4, 4, 4}, 0.3f), blob({4, 4, 1}, 0), blob({5, 1, 1}, 0),
                                                blob({1, 1, 1}, 0)};
  const Vec shift(3, -2, 7);
  for (const std::vector<Vec>& body : bodies) {
    Oracle oracle(weightless());
    add(oracle, {}, body);
    Matrix turn = Matrix::Identity();
    for (int c = 0; c < 8; ++c) {
      turn = Eigen::AngleAxisd(0.7, Vec(1, 2, -1).normalized()).matrix() * turn;
      std::vector<Vec> turned;
      for (const Vec& x : body) turned.push_back(turn * x + shift);
      oracle.set_positions(turned);
      oracle.step();
      for (std::size_t i = 0; i < body.size(); ++i) {
        EXPECT_LT((oracle.particles()[i].goal - turned[i]).norm(), 1e-11) << body.size() << " particles";
      }
    }
  }
}

TEST(oracle, shape_matching_conserves_linear_and_angular_momentum) {
  Oracle oracle(weightless());
  const std::vector<Vec> body = blob({5, 4, 4}, 0.3f);
  add(oracle, {}, body);
  std::vector<Vec> pulled;
  for (const Vec& x : body) pulled.push_back(x + Vec(0.3 * x.y(), 0.1 * x.z() * x.z(), -0.2 * x.x()));
  oracle.set_positions(pulled);
  oracle.step();
  Vec force = Vec::Zero(), torque = Vec::Zero();
  double largest = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vec pull = oracle.particles()[i].goal - pulled[i];
    force += pull;
    torque += pulled[i].cross(pull);
    largest = std::max(largest, pull.norm());
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(force.norm(), 1e-11);
  EXPECT_LT(torque.norm(), 1e-11);
}

TEST(oracle, rotation_is_the_polar_factor_and_never_a_reflection) {
  const Matrix turn = Eigen::AngleAxisd(2.0, Vec(1, -1, 3).normalized()).matrix();
  const Matrix stretch = Vec(1.0, 0.5, 0.25).asDiagonal();
  const Matrix none = Matrix::Identity();
  EXPECT_LT((polar_rotation(turn * stretch, none, 1) - turn).norm(), 1e-10);
  // One axis turned inside out: the weakest direction gives way.
  const Matrix mirror = Vec(1, 1, -1).asDiagonal();
  EXPECT_LT((polar_rotation(turn * mirror * stretch, none, 1) - turn).norm(), 1e-10);
  // A plane says all, a line all but the turn about itself, a point nothing.
  EXPECT_LT((polar_rotation(turn * Matrix(Vec(1, 0.5, 0).asDiagonal()), none, 1) - turn).norm(), 1e-10);
  const Matrix line = Vec(1, 0, 0).asDiagonal();
  const Matrix about_line = Eigen::AngleAxisd(1.1, Vec::UnitX()).matrix();
  EXPECT_LT((polar_rotation(line, about_line, 1) - about_line).norm(), 1e-10);
  EXPECT_NEAR(polar_rotation(turn * line, none, 1).determinant(), 1, 1e-12);
  EXPECT_LT((polar_rotation(turn * line, none, 1).col(0) - turn.col(0)).norm(), 1e-10);
  EXPECT_LT((polar_rotation(Matrix::Zero(), turn, 1) - turn).norm(), 1e-10);
}

TEST(oracle, full_lattice_is_at_rest_pressure) {
  for (const Material& material :
       {Material{.particle_mass = 2.5f}, Material{.rest_density = 700.0f}, Material{}}) {
    Oracle oracle(weightless(1.9f));
    add(oracle, material, blob({5, 5, 5}, 0));
    oracle.step();
    const Particle& middle = oracle.particles()[62];
    ASSERT_EQ(middle.x, Vec::Zero());
    EXPECT_NEAR(middle.density / oracle.groups()[0].rest_density, 1, 1e-12);
  }
}

TEST(oracle, mass_and_rest_density_follow_from_each_other) {
  const double sum = lattice_sum(1.0, 1.9f);
  const auto group_of = [](const Material& material) {
    Oracle oracle(weightless(1.9f));
    add(oracle, material, blob({1, 1, 1}, 0));
    return oracle.groups()[0];
  };
  EXPECT_DOUBLE_EQ(group_of({}).mass, 1);
  EXPECT_DOUBLE_EQ(group_of({}).rest_density, sum);
  EXPECT_DOUBLE_EQ(group_of({.rest_density = 8.0f}).mass, 8 / sum);
  EXPECT_DOUBLE_EQ(group_of({.particle_mass = 3.0f, .rest_density = 8.0f}).mass, 3);
  EXPECT_DOUBLE_EQ(group_of({.particle_mass = 3.0f, .rest_density = 8.0f}).rest_density, 8);
}

/// Two squeezed blobs of different materials that touch, all particles with a velocity of their own.
Oracle collision(Formulation formulation) {
  SolverConfig config = weightless();
  config.formulation = formulation;
  Oracle oracle(config);
  const Material soft{.alpha = 0.7f, .pressure_coefficient = 20.0f, .viscosity = 0.3f};
  const Material heavy{.alpha = 0.2f, .pressure_coefficient = 9.0f, .viscosity = 1.5f, .particle_mass = 2.5f};
  for (const auto& [material, z] : {std::pair(soft, 0.0f), std::pair(heavy, 3.1f)}) {
    std::vector<Vec> points = widened(lattice_points({4, 4, 4}, 0.8f, {0, 0, z}, 0.3f));
    oracle.add_body(points, shaken(points.size(), 0.5), 1.0, oracle.add_group(material));
  }
  return oracle;
}

Vec change_of_momentum_by_sph(const Oracle& oracle) {
  Vec sum = Vec::Zero();
  for (const Particle& p : oracle.particles()) sum += oracle.groups()[p.group].mass * (p.sph + p.crossing);
  return sum;
}

TEST(oracle, conservative_sums_keep_momentum_within_and_between_groups) {
  Oracle oracle = collision(Formulation::conservative);
  oracle.step();
  Vec within = Vec::Zero(), between = Vec::Zero();
  double largest_crossing = 0;
  for (const Particle& p : oracle.particles()) {
    if (p.group == 0) within += p.sph;
    between += oracle.groups()[p.group].mass * p.crossing;
    largest_crossing = std::max(largest_crossing, p.crossing.norm());
  }
  EXPECT_GT(largest_crossing, 1);
  EXPECT_LT(within.norm(), 1e-11);
  EXPECT_LT(between.norm(), 1e-11);
}

TEST(oracle, printed_sums_do_not_keep_momentum) {
  Oracle oracle = collision(Formulation::printed);
  oracle.step();
  EXPECT_GT(change_of_momentum_by_sph(oracle).norm(), 1);
}

TEST(oracle, printed_pressure_repels) {
  SolverConfig config = weightless();
  config.formulation = Formulation::printed;
  Oracle oracle(config);
  add(oracle, {.alpha = 1.0f, .viscosity = 0.0f, .particle_mass = 1.0f, .rest_density = 1e-3f},
      {{0, 0, 0}, {0.5, 0, 0}});
  oracle.step();
  EXPECT_LT(oracle.particles()[0].sph.x(), -1e-6);
  EXPECT_GT(oracle.particles()[1].sph.x(), 1e-6);
}

TEST(oracle, only_the_conservative_viscosity_lets_a_body_fly_on) {
  const auto largest_acceleration = [](Formulation formulation) {
    SolverConfig config = weightless();
    config.formulation = formulation;
    Oracle oracle(config);
    add(oracle, {.alpha = 1.0f, .pressure_coefficient = 0.0f}, blob({4, 4, 4}, 0.2f), {0, 0, -5});
    oracle.step();
    double largest = 0;
    for (const Particle& p : oracle.particles()) largest = std::max(largest, p.sph.norm());
    return largest;
  };
  EXPECT_LT(largest_acceleration(Formulation::conservative), 1e-12);
  EXPECT_GT(largest_acceleration(Formulation::printed), 1e-2);
}

TEST(oracle, coincident_particles_give_no_pressure) {
  Oracle oracle(weightless());
  add(oracle, {.alpha = 1.0f, .particle_mass = 1.0f, .rest_density = 1e-3f}, {{1, 2, 3}, {1, 2, 3}});
  oracle.step();
  ASSERT_GT(oracle.particles()[0].pressure, 0);
  EXPECT_EQ(oracle.particles()[0].sph, Vec::Zero());
}

TEST(oracle, cohesion_scales_negative_pressure) {
  for (const float cohesion : {0.0f, 0.25f, 1.0f}) {
    Oracle oracle(weightless());
    add(oracle, {.alpha = 1.0f, .cohesion = cohesion}, {{0, 0, 0}, {1.5, 0, 0}});
    oracle.step();
    const Particle& p = oracle.particles()[0];
    EXPECT_DOUBLE_EQ(p.pressure, cohesion * 16.0 * (p.density - oracle.groups()[0].rest_density));
  }
}

TEST(oracle, time_step_is_bounded_by_support_radius_sound_and_viscosity) {
  const auto bounded = [](float k, float mu, double speed, bool acoustic_limit, float alpha) {
    SolverConfig config = weightless(2.0f);
    config.acoustic_limit = acoustic_limit;
    Oracle oracle(config);
    add(oracle,
        {.alpha = alpha,
         .pressure_coefficient = k,
         .viscosity = mu,
         .particle_mass = 1.0f,
         .rest_density = 1.0f},
        {{0, 0, 0}}, {speed, 0, 0});
    return oracle.step().time_step;
  };
  EXPECT_NEAR(bounded(16, 0.5f, 0, false, 1), 0.15f, 1e-15);
  EXPECT_NEAR(bounded(16, 0.5f, 20, false, 1), 0.999 * 2 / 20, 1e-15);
  EXPECT_NEAR(bounded(16, 0.5f, 20, false, 0), 0.15f, 1e-15);
  EXPECT_NEAR(bounded(400, 0, 3, true, 1), std::sqrt(0.05 * 4 / 400), 1e-15);
  EXPECT_NEAR(bounded(400, 0, 3, true, 0.25f), std::sqrt(0.05 * 4 / 100), 1e-15);
  EXPECT_NEAR(bounded(400, 0.5f, 3, true, 1), std::sqrt(1.4 * 4 / 400), 1e-15);
  EXPECT_NEAR(bounded(16, 20, 0, true, 1), 4 / (25 * 20.0), 1e-15);
  EXPECT_NEAR(bounded(16, 20, 3, true, 0), 0.15f, 1e-15);
  EXPECT_THROW(bounded(16, 0.5f, 1e6, false, 1), std::runtime_error);
}

TEST(oracle, contact_ends_at_the_offset_what_would_cross_it_within_the_step) {
  const Collider floor{.shape = Plane{{0, 0, 2}, 0}};
  const Particle stopped = after_one_step(floor, {0, 0, 0.79}, {0.2, 0, -2});
  EXPECT_NEAR(stopped.x.z(), 0.5, 1e-14);
  EXPECT_NEAR(stopped.v.x(), 0.2, 1e-14);
  EXPECT_NEAR(stopped.contact.z(), (2 - 0.29 / double{0.15f}) / double{0.15f}, 1e-12);
  const Particle untouched = after_one_step(floor, {0, 0, 0.81}, {0.2, 0, -2});
  EXPECT_NEAR(untouched.v.z(), -2, 1e-14);
  EXPECT_EQ(untouched.contact, Vec::Zero());
}

TEST(oracle, contact_bounces_rubs_and_moves_with_its_collider) {
  const Particle bounced = after_one_step({.shape = Plane{}, .restitution = 0.5f}, {0, 0, 0.6}, {0, 0, -2});
  EXPECT_NEAR(bounced.v.z(), 1, 1e-14);
  const Particle rubbed = after_one_step({.shape = Plane{}, .friction = 0.25f}, {0, 0, 0.5}, {3, 0, -2});
  EXPECT_NEAR(rubbed.v.x(), 3 - 0.25f * 2, 1e-14);
  const Particle stuck = after_one_step({.shape = Plane{}, .friction = 2.0f}, {0, 0, 0.5}, {3, 0, -2});
  EXPECT_NEAR(stuck.v.norm(), 0, 1e-14);
  const Particle carried =
      after_one_step({.shape = Plane{}, .velocity = {1, 0, 0.5f}, .friction = 2.0f}, {0, 0, 0.5}, {0, 0, -2});
  EXPECT_LT((carried.v - Vec(1, 0, 0.5)).norm(), 1e-14);
}

TEST(oracle, deep_overlap_is_pushed_out_gently) {
  const Particle deep = after_one_step({.shape = Plane{}}, {0, 0, -3}, {0, 0, -2});
  EXPECT_NEAR(deep.v.z(), 2.2f / (10 * 0.15f), 1e-6);
  const Particle shallow = after_one_step({.shape = Plane{}}, {0, 0, 0.45}, {0, 0, -2});
  EXPECT_NEAR(shallow.x.z(), 0.5, 1e-14);
}

TEST(oracle, distances_are_exact) {
  const Box box{{-1, -2, -3}, {1, 2, 3}};
  EXPECT_NEAR(distance(box, Vec(4, 6, 0)).value, 5, 1e-15);
  EXPECT_LT((distance(box, Vec(4, 6, 0)).normal - Vec(0.6, 0.8, 0)).norm(), 1e-15);
  EXPECT_NEAR(distance(box, Vec(-0.75, 0, 0)).value, -0.25, 1e-15);
  EXPECT_EQ(distance(box, Vec(-0.75, 0, 0)).normal, Vec(-1, 0, 0));
  const Box kept_in{{-1, -2, -3}, {1, 2, 3}, true};
  EXPECT_NEAR(distance(kept_in, Vec(0, 0, 2.5)).value, 0.5, 1e-15);
  EXPECT_EQ(distance(kept_in, Vec(0, 0, 2.5)).normal, Vec(0, 0, -1));
  EXPECT_NEAR(distance(Sphere{{1, 0, 0}, 2, true}, Vec(1, 1.5, 0)).value, 0.5, 1e-15);
  EXPECT_NEAR(distance(Plane{{0, 3, 4}, 10}, Vec(0, 0, 0)).value, -2, 1e-15);
  EXPECT_NEAR(distance(Union{{Plane{}, Sphere{{0, 0, 4}, 1}}}, Vec(0, 0, 2.6)).value, 0.4, 1e-15);
}

TEST(oracle, reference_follows_where_the_mean_acceleration_is_above_the_threshold) {
  const auto updates = [](float alpha, float threshold) {
    Oracle oracle({.support_radius = 2.2f, .gravity = {0, 0, -0.4f}, .update_interval = 5});
    add(oracle, {.alpha = alpha, .update_threshold = threshold}, blob({3, 3, 3}, 0));
    std::vector<int> at;
    for (int c = 0; c < 12; ++c) {
      if (!oracle.step().updated_groups.empty()) at.push_back(c);
    }
    return at;
  };
  const std::vector<int> at_checks{5, 10};
  EXPECT_EQ(updates(0.0f, 0.39f), at_checks);
  EXPECT_EQ(updates(0.0f, 0.41f), std::vector<int>{});
  EXPECT_EQ(updates(0.5f, 0.79f), at_checks);
  EXPECT_EQ(updates(0.5f, 0.81f), std::vector<int>{});
}

TEST(oracle, pinned_particles_move_as_prescribed_and_do_not_count_in_the_update) {
  Oracle oracle({.support_radius = 2.2f, .gravity = {0, 0, -0.4f}, .update_interval = 5});
  const std::vector<Vec> body = blob({3, 3, 3}, 0);
  add(oracle, {.update_threshold = 0.1f}, body);
  oracle.pin({{-9, -9, -9}, {9, 9, 9}}, {0.5, 0, 0});
  double time = 0;
  for (int c = 0; c < 12; ++c) {
    const Step step = oracle.step();
    time += step.time_step;
    EXPECT_TRUE(step.updated_groups.empty());
  }
  for (std::size_t i = 0; i < body.size(); ++i) {
    EXPECT_LT((oracle.particles()[i].x - body[i] - Vec(0.5 * time, 0, 0)).norm(), 1e-13);
  }
}

TEST(oracle, alpha_is_linear_between_keys) {
  const AlphaSchedule schedule{{1.0f, 0.25f}, {3.0f, 0.75f}, {4.0f, 0.0f}};
  EXPECT_DOUBLE_EQ(alpha_at(schedule, 0), 0.25);
  EXPECT_DOUBLE_EQ(alpha_at(schedule, 2), 0.5);
  EXPECT_DOUBLE_EQ(alpha_at(schedule, 3.5), 0.375);
  EXPECT_DOUBLE_EQ(alpha_at(schedule, 9), 0);
}

}  // namespace oracle_test
}  // namespace mallow::oracle

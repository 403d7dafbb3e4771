#include "textbook/textbook.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "mallow/errors.h"
#include "oracle/points.h"
#include "paper_settings.h"
#include "simulation/oracle_cases.h"

namespace mallow::textbook {
namespace textbook_test {

constexpr int k_steps = 40;
/// Only the order of the sums tells the textbook from the oracle: 2.5e-13 was the largest difference seen.
constexpr double k_tolerance = 1e-11;

Textbook textbook_of(const Case& scene) {
  Textbook textbook(scene.solver);
  std::size_t group = 0;
  for (const Blob& blob : scene.blobs) {
    if (!blob.joins_the_one_before) group = textbook.add_group(blob.material);
    const std::size_t first = textbook.size();
    textbook.add_body(
        {.positions = points_of(blob), .spacing = blob.spacing, .velocity = blob.velocity, .velocities = {}},
        group);
    const std::vector<float> alphas = alphas_of(blob), stiffnesses = stiffnesses_of(blob);
    for (std::size_t k = 0; k < alphas.size(); ++k)
      textbook.paint(first + k, double{alphas[k]}, double{stiffnesses[k]});
    const std::vector<float> yields = yields_of(blob);
    for (std::size_t k = 0; k < yields.size(); ++k) textbook.paint_yield(first + k, double{yields[k]});
  }
  for (const Collider& collider : scene.colliders) textbook.add_collider(collider);
  for (const Pinned& pin : scene.pins) textbook.pin(pin.box, pin.velocity);
  return textbook;
}

/// The oracle's cases that the textbook can run: it takes no force callback, its walls do not press, nothing
/// carries heat, bodies do not touch by constraint and nothing comes or goes while it runs. What the engine
/// is timed against and measured by has none of these. Then one with everything at once.
std::vector<Case> cases() {
  std::vector<Case> cases;
  for (Case scene : oracle_cases()) {
    const auto is_heated = [](const Blob& blob) { return blob.material.temperature.has_value(); };
    const bool touches = scene.solver.contact == BodyContact::constraint && scene.blobs.size() > 1;
    if (touches || !scene.drains.empty()) continue;
    if (scene.wind || scene.name.starts_with("walled") || !scene.nozzles.empty() ||
        std::ranges::any_of(scene.blobs, is_heated))
      continue;
    scene.solver.wall_pressure = false;
    cases.push_back(scene);
  }
  Case all{.name = "everything_at_once", .blobs = {}, .solver = {}};
  all.solver = {
      .time_step = 0.15f, .support_radius = 2.2f, .gravity = {0.05f, 0, -0.4f}, .update_interval = 10};
  all.solver.formulation = Formulation::printed;
  all.solver.wall_pressure = false;
  all.solver.contact = BodyContact::pressure;
  all.blobs = {{.material = {.alpha = {{0.5f, 0.8f}, {2.0f, 0.3f}}, .update_threshold = 0.5f},
                .center = {0, 0, 3.4f},
                .velocity = {0, 0, -0.5f},
                .count = {5, 5, 5}},
               {.material = {.alpha = {{1.0f, 0.2f}, {3.0f, 1.0f}}, .viscosity = 0, .particle_mass = 2.0f},
                .center = {0.3f, 0.2f, 8.4f},
                .velocity = {0, 0, -1},
                .count = {5, 5, 5}},
               {.center = {6.5f, 0, 4.0f}, .count = {3, 3, 3}, .joins_the_one_before = true}};
  all.colliders = {{.shape = Plane{{0.3f, -0.2f, 1.0f}, 0.1f}, .velocity = {0, 0, 0.2f}, .friction = 0.3f}};
  all.pins = {{.box = {{6, -9, 4.5f}, {9, 9, 9}}, .velocity = {0, 0.1f, 0}}};
  all.updates = 2;
  for (Blob& b : all.blobs) b.material = with_paper_settings(b.material);
  cases.push_back(all);
  return cases;
}

class textbook_case : public testing::TestWithParam<Case> {};

TEST_P(textbook_case, agrees_with_the_oracle) {
  const Case& scene = GetParam();
  oracle::Oracle oracle = oracle_of(scene);
  Textbook textbook = textbook_of(scene);
  int updates = 0;
  for (int c = 0; c < k_steps; ++c) {
    const oracle::Step expected = oracle.step();
    const Textbook::Step step = textbook.step();
    ASSERT_NEAR(step.time_step / expected.time_step, 1, k_tolerance) << "step " << c;
    ASSERT_NEAR(step.max_velocity, expected.max_velocity, k_tolerance * (1 + expected.max_velocity));
    ASSERT_EQ(static_cast<std::size_t>(step.updated_references), expected.updated_groups.size())
        << "step " << c;
    ASSERT_EQ(step.volume_iterations, expected.volume_iterations) << "step " << c;
    updates += step.updated_references;
  }
  EXPECT_GE(updates, scene.updates);
  EXPECT_LE(largest_deviation(scene, oracle.positions(), textbook.positions()), k_tolerance)
      << "in units of h";
  EXPECT_LE(largest_deviation(scene, oracle.velocities(), textbook.velocities()), k_tolerance) << "in h/s";
}

INSTANTIATE_TEST_SUITE_P(scenes, textbook_case, testing::ValuesIn(cases()),
                         [](const auto& scene) { return scene.param.name; });

SolverConfig weightless() {
  return with_paper_settings(SolverConfig{.support_radius = 2.2f, .gravity = {0, 0, 0}});
}

TEST(textbook, free_fall_equals_the_recurrence) {
  for (const float alpha : {0.0f, 0.4f, 1.0f}) {
    SolverConfig config = weightless();
    config.gravity = {0.1f, 0, -0.4f};
    Textbook textbook(config);
    // Without pressure, as points that are not at rest pressure would swell as they fall.
    const Material material{.alpha = alpha, .pressure_coefficient = 0};
    const Body body{.positions = oracle::lattice_points({4, 4, 4}, 1.0f, {0, 0, 0}, 0.2f),
                    .spacing = 1.0f,
                    .velocity = {0.3f, 0, 1}};
    textbook.add_body(body, textbook.add_group(material));
    Vec v = body.velocity.cast<double>(), moved = Vec::Zero();
    for (int c = 0; c < k_steps; ++c) {
      const double dt = textbook.step().time_step;
      v += dt * config.gravity.cast<double>();
      moved += dt * v;
    }
    for (std::size_t i = 0; i < textbook.size(); ++i) {
      const Vec start = body.positions[i].cast<double>();
      EXPECT_LT((textbook.positions()[i] - start - moved).norm(), 1e-11) << "alpha " << alpha;
    }
  }
}

struct Momentum {
  Vec linear{0, 0, 0}, angular{0, 0, 0};
};
Momentum momentum_of(const Textbook& textbook) {
  Momentum sum;
  for (const Particle& p : textbook.particles()) {
    const Vec mv = textbook.groups()[p.group].mass * p.velocity;
    sum.linear += mv;
    sum.angular += p.position.cross(mv);
  }
  return sum;
}

TEST(textbook, conserves_linear_and_angular_momentum) {
  // Viscosity acts along the difference of the velocities, so the angular momentum is not kept with it.
  const Material elastic{.alpha = 0.0f, .viscosity = 0};
  const Material paste{.alpha = 0.6f, .update_threshold = 0, .viscosity = 0, .particle_mass = 2.5f};
  Textbook textbook(weightless());
  const auto add = [&](const Material& material, const Vec3& center, const Vec3& velocity) {
    Body body{.positions = oracle::lattice_points({5, 4, 4}, 1.0f, center, 0.3f),
              .spacing = 1.0f,
              .velocity = velocity};
    for (const Vec3& x : body.positions) body.velocities.push_back(Vec3(0.1f, 0.2f, 0.15f).cross(x - center));
    textbook.add_body(body, textbook.add_group(material));
  };
  add(elastic, {0, 0, 0}, {0.1f, 0, 0.6f});
  add(paste, {1, 0.5f, 5}, {0, 0, -0.6f});
  const Momentum before = momentum_of(textbook);
  double largest_push = 0;
  for (int c = 0; c < 300; ++c) {
    textbook.step();
    for (const Particle& p : textbook.particles())
      largest_push = std::max(largest_push, p.external_acceleration.norm());
  }
  EXPECT_GT(largest_push, 0.1) << "the bodies never touched";
  const Momentum after = momentum_of(textbook);
  EXPECT_LT((after.linear - before.linear).norm(), 1e-11 * before.linear.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 1e-11 * before.angular.norm());
}

TEST(textbook, runs_only_what_a_scene_needs) {
  const auto after_one_step = [](const Material& material) {
    Textbook textbook(weightless());
    textbook.add_body(
        {.positions = oracle::lattice_points({4, 4, 4}, 1.0f), .spacing = 1.0f, .velocities = {}},
        textbook.add_group(material));
    textbook.step();
    return textbook;
  };
  const Textbook elastic = after_one_step({.alpha = 0.0f});
  EXPECT_EQ(elastic.densities()[0], 0);
  EXPECT_TRUE(elastic.particles()[0].neighbors.empty());
  EXPECT_GT(elastic.average_neighbors(0), 1);
  const Textbook fluid = after_one_step({.alpha = 1.0f});
  EXPECT_GT(fluid.densities()[0], 0);
  EXPECT_EQ(fluid.average_neighbors(0), 0);
}

TEST(textbook, refuses_a_step_below_a_thousandth_and_names_the_particle) {
  for (const float speed : {1e6f, std::numeric_limits<float>::quiet_NaN()}) {
    Textbook textbook(weightless());
    Body body{.positions = oracle::lattice_points({3, 3, 3}, 1.0f), .spacing = 1.0f};
    body.velocities.assign(body.positions.size(), Vec3(0, 0, 0));
    body.velocities[7] = {speed, 0, 0};
    textbook.add_body(body, textbook.add_group({.alpha = 1.0f, .viscosity = 0}));
    try {
      textbook.step();
      FAIL() << "a step at " << speed << " m/s was taken";
    } catch (const StepError& error) {
      EXPECT_EQ(error.particle_id(), 7u) << error.what();
    }
    EXPECT_EQ(textbook.positions()[7], body.positions[7].cast<double>());
  }
}

}  // namespace textbook_test
}  // namespace mallow::textbook

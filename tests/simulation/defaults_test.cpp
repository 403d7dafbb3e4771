#include "mallow/defaults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "config/field_tables.h"
#include "mallow/mallow.h"

namespace mallow {
namespace defaults_test {

Body cube(int side, float spacing, const Vec3& corner = {0, 0, 0}) {
  return sample(Lattice{.count = {side, side, side}, .spacing = spacing, .corner = corner});
}

/// Metres, under the gravity of the earth.
SolverConfig in_metres(float spacing) {
  return {.support_radius = 2.1f * spacing, .gravity = {0, 0, -9.81f}, .threads = 1};
}

std::string refusal(Simulation& s) {
  try {
    s.prepare();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(defaults, are_the_papers_numbers_at_its_spacing_and_gravity) {
  Simulation s({.support_radius = 2.1f, .gravity = {0, 0, -0.3f}});
  s.add_body(cube(4, 1), {.alpha = 0.7f});
  const SimulationInfo info = s.info();
  EXPECT_EQ(info.time_step, 0.15f);
  EXPECT_EQ(info.time_step_source, TimeStepSource::gravity);
  EXPECT_EQ(info.bodies[0].update_threshold, 12.0f);
  EXPECT_EQ(info.bodies[0].viscosity, 0.5f);
  EXPECT_EQ(info.update_period, 60 * static_cast<double>(0.15f));
  EXPECT_EQ(s.config().time_step, 0.15f);
  // 60 steps, as the paper has it.
  Simulation fires({.support_radius = 2.1f, .gravity = {0, 0, -0.3f}});
  fires.add_body(cube(4, 1), {.alpha = 0.0f, .update_threshold = 0.1f});
  for (int k = 0; k < 200; ++k) EXPECT_EQ(fires.step().updated_references, k > 0 && k % 60 == 0 ? 1 : 0) << k;
}

TEST(defaults, follow_the_smallest_spacing_and_gravity_as_lengths_and_times_do) {
  for (const float scale : {1e-3f, 0.1f, 50.0f})
    for (const float gravity : {1e-3f, 9.81f, 1e4f}) {
      const SceneScale scene{.spacing = scale, .gravity = {gravity, 0, 0}};
      const float step = *default_time_step(scene);
      EXPECT_NEAR(step * std::sqrt(gravity / scale), 0.15f * std::sqrt(0.3f), 1e-7f);
      EXPECT_FLOAT_EQ(default_update_threshold(scene, step), 40 * gravity);
      EXPECT_FLOAT_EQ(default_kinematic_viscosity(scene, step),
                      0.5f * scale * std::sqrt(gravity * scale / 0.3f));
      const SceneScale weightless{.spacing = scale, .gravity = {0, 0, 0}};
      EXPECT_NEAR(default_update_threshold(weightless, step) / default_update_threshold(scene, step), 1,
                  1e-6);
      EXPECT_NEAR(default_kinematic_viscosity(weightless, step) / default_kinematic_viscosity(scene, step), 1,
                  1e-6);
    }
  Simulation s(in_metres(0.1f));
  s.add_body(cube(3, 0.1f), {.alpha = 0.5f});
  s.add_body(cube(4, 0.05f, {1, 0, 0}), {.alpha = 0.5f});
  EXPECT_FLOAT_EQ(s.info().time_step, *default_time_step({.spacing = 0.05f, .gravity = {0, 0, -9.81f}}));
}

TEST(defaults, without_gravity_follow_the_fastest_body_and_are_refused_where_nothing_moves) {
  SolverConfig config = in_metres(0.1f);
  config.gravity = {0, 0, 0};
  Simulation flies(config);
  Body body = cube(3, 0.1f);
  body.velocity = {3, 0, 4};
  flies.add_body(body, {.alpha = 0.5f});
  EXPECT_FLOAT_EQ(flies.info().time_step, 0.3f * 0.1f / 5);
  EXPECT_EQ(flies.info().time_step_source, TimeStepSource::speed);
  EXPECT_FLOAT_EQ(flies.info().bodies[0].update_threshold, 0.27f * 0.1f / (0.006f * 0.006f));

  Simulation still(config);
  still.add_body(cube(3, 0.1f), {.alpha = 0.5f});
  EXPECT_NE(refusal(still).find("solver.time_step: is missing"), std::string::npos) << refusal(still);
  still.add_collider({.shape = Plane{{0, 0, 1}, -1}, .velocity = {0, 0, 0.5f}});
  EXPECT_FLOAT_EQ(still.info().time_step, 0.3f * 0.1f / 0.5f) << "what was refused can be mended";
}

TEST(defaults, are_settled_once) {
  Simulation s(in_metres(0.1f));
  const BodyId group = s.add_body(cube(3, 0.1f), {.alpha = 0.5f});
  const float before = s.info().time_step;
  for (int k = 0; k < 5; ++k) s.step();
  s.add_body(cube(3, 0.02f, {3, 0, 0}), {.alpha = 0.5f});
  EXPECT_EQ(s.info().time_step, before);
  s.set_alpha(s.material(group), 0.25f);
  s.step();
  const SimulationInfo info = s.info();
  const float expected = 0.21f / before * (0.21f / before);
  EXPECT_NEAR(info.bodies[0].pressure_coefficient / (expected / 0.25f), 0.925, 1e-6) << "k follows alpha";
  EXPECT_FLOAT_EQ(info.bodies[1].pressure_coefficient, expected / 0.5f);
  const Simulation again = Simulation::restore(s.save());
  EXPECT_EQ(again.config().time_step, before);
}

TEST(defaults, keep_a_cohesive_body_together) {
  for (const float alpha : {0.3f, 0.9f, 1.0f}) {
    SolverConfig config = in_metres(0.1f);
    config.gravity = {0, 0, 0};
    config.time_step = 0.0083f;
    Simulation s(config);
    s.add_body(cube(7, 0.1f), {.alpha = alpha, .rest_density = 1000.0f, .cohesion = 1.0f});
    float fastest = 0, last = 0;
    for (int k = 0; k < 100; ++k) {
      s.step();
      last = 0;
      for (const Vec3& v : s.velocities_by_id()) last = std::max(last, v.norm());
      fastest = std::max(fastest, last);
    }
    EXPECT_LT(fastest * 0.0083f, 0.4f * 0.1f) << "alpha " << alpha << ", as with the paper's coefficient";
    EXPECT_LT(last * 0.0083f, 0.1f * 0.1f) << "alpha " << alpha;
  }
}

// A modulus that Δt0 does not carry, and shorter steps do. What 2.6 leaves was below 0 then: matter drew
// itself together, and gained seven times its energy in five steps.
TEST(defaults, never_give_a_pressure_that_draws) {
  for (const float share : {0.5f, 0.99f, 2.0f, 20.0f}) {
    SolverConfig config{
        .time_step = 0.15f, .gravity = {0, 0, 0}, .volume_iterations = 0, .sleep_speed = 0.0f, .threads = 1};
    config.time_step_factor = std::min(1.0f, 1 / std::sqrt(share));
    // a = share · 2.5 in a step of Δt0.
    const Material material{
        .alpha = 0.5f, .update_threshold = 1e30f, .elastic_time_step = 0.5f * 0.15f / (2.49f * share)};
    Simulation s(config);
    Body body = sample(Lattice{.count = {5, 5, 5}, .jitter = 0});
    for (const Vec3& x : body.positions)
      body.velocities.push_back(Vec3(std::sin(x.y()), std::sin(x.z()), std::sin(x.x())));
    s.add_body(body, material);
    s.prepare();
    EXPECT_GT(s.info().bodies[0].pressure_coefficient, 0) << share;
    s.step();
    const double first = s.energy().conserved;
    for (int k = 0; k < 200; ++k) {
      s.step();
      ASSERT_LT(s.energy().conserved, 1.03 * first) << share << ' ' << k;
    }
  }
}

TEST(defaults, do_not_shorten_steps_by_the_speed_of_sound) {
  for (const float alpha : {0.01f, 0.05f, 0.1f, 0.3f, 0.7f, 1.0f}) {
    Simulation s(in_metres(0.1f));
    s.add_body(cube(4, 0.1f), {.alpha = alpha, .rest_density = 1000.0f});
    EXPECT_GE(s.info().unlimited_step, static_cast<double>(s.info().time_step)) << "alpha " << alpha;
    EXPECT_FALSE(s.step().limited) << "alpha " << alpha;
  }
}

TEST(defaults, given_numbers_stay) {
  Simulation s(
      {.time_step = 0.01f, .support_radius = 0.3f, .gravity = {0, 0, -9.81f}, .update_period = 0.5f});
  s.add_body(cube(3, 0.1f), {.update_threshold = 7.0f, .pressure_coefficient = 0.0f});
  const SimulationInfo info = s.info();
  EXPECT_EQ(info.time_step, 0.01f);
  EXPECT_EQ(info.time_step_source, TimeStepSource::given);
  EXPECT_EQ(info.update_period, 0.5);
  EXPECT_EQ(info.bodies[0].update_threshold, 7.0f);
  EXPECT_EQ(info.bodies[0].pressure_coefficient, 0.0f);
}

TEST(update_period, checks_at_the_first_step_at_or_after_its_multiples_at_any_step) {
  for (const float factor : {1.0f, 0.5f, 0.3f}) {
    Simulation s({.time_step = 0.1f,
                  .time_step_factor = factor,
                  .support_radius = 2.1f,
                  .gravity = {0, 0, -0.3f},
                  .update_period = 0.75f});
    s.add_body(cube(3, 1), {.alpha = 0.0f, .update_threshold = 0.1f});
    double last = 0;
    for (int k = 0; k < 100; ++k) {
      const double start = s.time();
      const bool due = std::floor(start / 0.75 + 1e-6) > std::floor(last / 0.75 + 1e-6);
      EXPECT_EQ(s.step().updated_references, due ? 1 : 0) << "at " << start << ", factor " << factor;
      last = start;
    }
  }
}

TEST(update_period, goes_on_with_the_same_bits_where_it_was_saved_within_what_the_check_judges) {
  const auto make = [] {
    Simulation s({.time_step_factor = 0.25f,
                  .support_radius = 2.1f,
                  .gravity = {0, 0, -0.3f},
                  .update_period = 1.0f,
                  .threads = 1});
    s.add_body(cube(5, 1, {0, 0, 0.5f}), {.alpha = 0.3f, .update_threshold = 0.9f});
    s.add_collider({.shape = Plane{}});
    return s;
  };
  Simulation whole = make();
  int updates = 0;
  for (int k = 0; k < 160; ++k) updates += whole.step().updated_references;
  EXPECT_GT(updates, 0);
  for (const int cut : {25, 26, 27, 53}) {
    Simulation first = make();
    for (int k = 0; k < cut; ++k) first.step();
    Simulation rest = Simulation::restore(first.save(), 1);
    for (int k = cut; k < 160; ++k) rest.step();
    EXPECT_EQ(rest.state_hash(), whole.state_hash()) << "saved after " << cut << " steps";
  }
}

TEST(update_period, free_fall_and_rest_are_no_blows) {
  for (const float alpha : {0.0f, 0.3f, 0.9f}) {
    SolverConfig config = in_metres(0.1f);
    config.update_period = 0.05f;
    Simulation s(config);
    s.add_body(cube(5, 0.1f, {0, 0, 2}), {.alpha = alpha});
    for (int k = 0; k < 60; ++k) EXPECT_EQ(s.step().updated_references, 0) << "alpha " << alpha;
  }
}

TEST(radius, below_the_spacing_is_refused_with_one_that_would_do) {
  Simulation s({.support_radius = 0.0021f, .gravity = {0, 0, -9.81f}});
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    try {
      s.add_body(cube(6, 1), {.alpha = alpha});
      ADD_FAILURE() << "alpha " << alpha;
    } catch (const ConfigError& error) {
      const std::string text = error.what();
      for (const char* words : {"solver.support_radius: 0.0021", "1 m apart", "2.1 m", "39"})
        EXPECT_NE(text.find(words), std::string::npos) << words << " in " << text;
    }
  }
  EXPECT_EQ(s.particle_count(), 0u);
  EXPECT_NO_THROW(s.add_body(Body{.positions = {{0, 0, 0}}}, {.alpha = 0.5f})) << "one particle needs none";

  Simulation regions({.support_radius = 2.1f});
  try {
    regions.add_body(cube(4, 1), {.alpha = 0.5f, .region_radius = 0.5f});
    ADD_FAILURE();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems()[0].field, "material.region_radius");
  }
  EXPECT_THROW(regions.add_body(Body{.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}}}, {.alpha = 1}),
               ConfigError)
      << "the spacing says 1, the points are 9 apart";
}

TEST(radius, of_thousands_of_spacings_is_refused_before_anything_is_allocated) {
  Simulation s({.support_radius = 2.1f, .gravity = {0, 0, -9.81f}});
  s.add_body(cube(40, 0.001f), {.alpha = 0.5f});
  const std::string text = refusal(s);
  for (const char* words :
       {"solver.support_radius: 2.1 ", "3.87924e+10 neighbours", "64000", "GiB", "0.0021 m"})
    EXPECT_NE(text.find(words), std::string::npos) << words << " in " << text;

  Simulation small({.support_radius = 2.1f, .memory_limit = 1e-6f});
  small.add_body(cube(5, 1), {.alpha = 0.0f});
  EXPECT_NE(refusal(small).find("solver.memory_limit"), std::string::npos) << refusal(small);
}

TEST(defaults, are_settled_by_the_first_prepare_that_does_not_throw) {
  const auto settled_by = [](Simulation& s, float spacing) {
    s.add_body(cube(5, spacing), {.alpha = 0.5f});
    s.prepare();
    return s.config();
  };
  Simulation s({.gravity = {0, 0, -9.81f}, .memory_limit = 1e-6f}), other({.gravity = {0, 0, -9.81f}});
  const BodyId coarse = s.add_body(cube(5, 1), {.alpha = 0.5f});
  EXPECT_THROW(s.prepare(), ConfigError);
  s.remove_body(coarse);
  SolverConfig more = s.config();
  more.memory_limit = 1;
  s.set_solver(more);
  const SolverConfig config = settled_by(s, 0.1f), expected = settled_by(other, 0.1f);
  EXPECT_EQ(config.support_radius, expected.support_radius);
  EXPECT_EQ(config.time_step, expected.time_step);
}

bool warns(const SimulationInfo& info, const std::string& words) {
  return std::any_of(info.warnings.begin(), info.warnings.end(),
                     [&](const std::string& text) { return text.find(words) != std::string::npos; });
}

TEST(warnings, are_none_for_settings_that_are_left_out) {
  for (const float alpha : {0.0f, 0.01f, 0.3f, 0.9f, 0.98f, 1.0f}) {
    Simulation s(in_metres(0.1f));
    s.add_body(cube(4, 0.1f), {.alpha = alpha, .rest_density = 1000.0f});
    EXPECT_TRUE(s.info().warnings.empty()) << s.info().warnings[0];
  }
}

TEST(warnings, name_bodies_that_start_within_each_other) {
  SolverConfig config = in_metres(0.1f);
  config.support_radius = 0.21f;
  Simulation s(config);
  s.add_body(cube(4, 0.1f), {.rest_density = 1000.0f}, "one");
  s.add_body(cube(4, 0.1f, {0.25f, 0.05f, 0.05f}), {.rest_density = 1000.0f}, "two");
  s.add_body(cube(4, 0.1f, {0, 0, 0.45f}), {.rest_density = 1000.0f}, "three, which touches");
  const std::vector<std::string> all = s.info().warnings;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].find("body 'one': "), 0u);
  EXPECT_NE(all[0].find("of 64 particles start within another body"), std::string::npos) << all[0];
  EXPECT_EQ(all[1].find("body 'two': "), 0u);
  s.step();
  EXPECT_TRUE(s.info().warnings.empty()) << "they are on their way";
}

TEST(warnings, name_what_is_hardly_meant) {
  const auto info_of = [](const Material& material, float time_step = 0.008f) {
    SolverConfig config = in_metres(0.1f);
    config.time_step = time_step;
    Simulation s(config);
    s.add_body(cube(4, 0.1f), material);
    return s.info();
  };
  EXPECT_TRUE(warns(info_of({.alpha = 0.0f, .update_threshold = 12.0f}), "update_threshold 12"));
  EXPECT_FALSE(warns(info_of({.alpha = 0.0f, .update_threshold = 20.0f}), "update_threshold"));
  EXPECT_TRUE(warns(info_of({.alpha = 0.5f, .update_threshold = 39.0f}), "update_threshold 39"));
  EXPECT_FALSE(warns(info_of({.alpha = 1.0f, .update_threshold = 0.0f}), "update_threshold")) << "a fluid";
  EXPECT_TRUE(warns(info_of({.particle_mass = 1e-9f}), "rest density"));
  EXPECT_TRUE(warns(info_of({.rest_density = 40000.0f}), "rest density"));
  EXPECT_FALSE(warns(info_of({.rest_density = 20000.0f}), "rest density"));
  EXPECT_TRUE(warns(info_of({.alpha = 0.5f, .pressure_coefficient = 1e5f}, 0.05f), "pressure_coefficient"));
  EXPECT_TRUE(warns(info_of({.alpha = 0.5f, .viscosity = 0.0f}), "too low to calm"));
  EXPECT_TRUE(
      warns(info_of({.alpha = 0.5f, .viscosity = 1e4f, .rest_density = 1000.0f}, 0.05f), "viscosity"));
}

TEST(support_radius, left_out_is_that_of_the_coarsest_body_and_the_same_as_given) {
  const auto run = [](const SolverConfig& config) {
    Simulation s(config);
    s.add_body(cube(4, 0.01f, {0, 0, 0.005f}),
               Material{.alpha = 0.5f, .youngs_modulus = 5e3f, .rest_density = 1000.0f});
    s.add_body(cube(4, 0.02f, {0.2f, 0, 0.01f}), Material{.alpha = 1.0f, .rest_density = 1000.0f});
    s.add_collider({.shape = Plane{}});
    for (int k = 0; k < 20; ++k) s.step();
    EXPECT_EQ(s.info().support_radius, default_support_radius(0.02f));
    Simulation again = Simulation::restore(s.save());
    again.step();
    s.step();
    EXPECT_EQ(again.state_hash(), s.state_hash());
    return s.state_hash();
  };
  SolverConfig left_out = in_metres(0.02f), given = left_out;
  left_out.support_radius.reset();
  given.support_radius = default_support_radius(0.02f);
  EXPECT_EQ(run(left_out), run(given));
}

/// The numbers in what a field table says of a setting that is left out.
template <class Config, class T>
std::vector<float> left_out(T Config::*member) {
  std::string text;
  for_fields<Config>([&](const auto& field) {
    if constexpr (std::is_same_v<decltype(field.member), T Config::*>)
      if (field.member == member) text = field.left_out;
  });
  std::vector<float> numbers;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t length = 1;
    if (std::isdigit(static_cast<unsigned char>(text[at])) != 0)
      numbers.push_back(std::stof(text.substr(at), &length));
    at += length;
  }
  return numbers;
}

TEST(defaults, are_the_numbers_that_field_tables_say_in_words) {
  using Numbers = std::vector<float>;
  EXPECT_EQ(left_out(&SolverConfig::support_radius), Numbers{default_support_radius(1)});
  EXPECT_EQ(left_out(&SolverConfig::update_period), Numbers{static_cast<float>(default_update_period(1))});
  EXPECT_EQ(left_out(&Material::update_threshold),
            Numbers{default_update_threshold({.gravity = {0, 0, -1}}, 1)});
  EXPECT_EQ(left_out(&SolverConfig::volume_iterations),
            (Numbers{static_cast<float>(default_volume_iterations(true)),
                     static_cast<float>(default_volume_iterations(false))}));
}

}  // namespace defaults_test
}  // namespace mallow

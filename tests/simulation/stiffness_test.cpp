// A Young's modulus in pascals is what it says: at any spacing, step and alpha.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "bars/bar.h"
#include "mallow/mallow.h"
#include "mallow/quality.h"

namespace mallow {
namespace stiffness_test {

using bars::Bar;
using bars::Swing;

/// The same bar of finer particles; its step follows them.
Bar refined(Bar bar, double by) {
  bar.spacing /= by;
  bar.across = static_cast<int>(std::lround(bar.across * by));
  bar.along = static_cast<int>(std::lround(bar.along * by));
  bar.time_step /= by;
  return bar;
}

Bar stepped(Bar bar, double by) {
  bar.time_step *= by;
  return bar;
}

void expect_within(const Swing& got, const Swing& wanted, double share, const std::string& what) {
  if (wanted.rest > 0) {
    EXPECT_NEAR(got.rest / wanted.rest, 1, share) << what << ", at rest";
  }
  EXPECT_NEAR(got.period / wanted.period, 1, share) << what << ", period";
}

/// A cube of 4³, metres, 9.81 m/s².
Body cube(float spacing, const Vec3& corner = {0, 0, 0}) {
  return sample(Lattice{.count = {4, 4, 4}, .spacing = spacing, .corner = corner});
}
SolverConfig in_metres(float spacing = 0.01f) {
  return {.support_radius = 2.1f * spacing, .gravity = {0, 0, -9.81f}, .threads = 1};
}
Material stiff(float modulus, float alpha = 0) {
  return {.alpha = alpha, .youngs_modulus = modulus, .rest_density = 1000.0f};
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(youngs_modulus, bends_the_same_at_any_step) {
  for (const double alpha : {0.0, 0.3}) {
    const Bar bar{.alpha = alpha};
    const Swing swing = bars::bend(bar);
    for (const double by : {0.25, 0.5, 2.0})
      expect_within(bars::bend(stepped(bar, by)), swing, alpha > 0 ? 0.05 : 0.001,
                    "alpha " + std::to_string(alpha) + ", step times " + std::to_string(by));
  }
}

TEST(youngs_modulus, bends_the_same_at_any_spacing) {
  for (const double alpha : {0.0, 0.3}) {
    const Bar bar{.alpha = alpha};
    const Swing swing = bars::bend(bar);
    for (const double by : {1.5, 2.0})
      expect_within(bars::bend(refined(bar, by)), swing, alpha > 0 ? 0.1 : 0.03,
                    "alpha " + std::to_string(alpha) + ", spacing over " + std::to_string(by));
  }
}

TEST(youngs_modulus, is_that_of_the_theory_of_bars) {
  for (const double alpha : {0.0, 0.3}) {
    const Bar bar{.alpha = alpha};
    const std::string name = "alpha " + std::to_string(alpha);
    expect_within(bars::bend(bar), bars::theory_of_bend(bar), 0.08, name + ", bent");
    expect_within(bars::stretch(bar), bars::theory_of_stretch(bar), 0.06, name + ", stretched");
    // Regions resist gradients of rotation: a fifth too stiff here, and less where there are more particles.
    expect_within(bars::twist(bar), bars::theory_of_twist(bar), 0.11, name + ", twisted");
  }
}

TEST(youngs_modulus, needs_no_region_a_particle_and_no_radius_of_its_own) {
  const Bar bar;
  const Swing swing = bars::bend(bar);
  Bar sparse = bar, wide = bar;
  sparse.region_stride = 3;
  wide.radius = 2.9;
  expect_within(bars::bend(sparse), swing, 0.1, "every third region");
  expect_within(bars::bend(wide), swing, 0.1, "wider regions");
}

TEST(youngs_modulus, shortens_a_step_that_is_left_out_and_nothing_else_that_has_a_pace) {
  Simulation soft(in_metres()), hard(in_metres());
  soft.add_body(cube(0.01f), stiff(5e3f));
  hard.add_body(cube(0.01f), stiff(1e6f));
  const SimulationInfo a = soft.info(), b = hard.info();
  EXPECT_EQ(a.time_step_source, TimeStepSource::gravity);
  EXPECT_EQ(b.time_step_source, TimeStepSource::modulus);
  EXPECT_LT(b.time_step, 0.2f * a.time_step);
  EXPECT_EQ(a.update_period, b.update_period);
  EXPECT_EQ(a.bodies[0].update_threshold, b.bodies[0].update_threshold);
  EXPECT_EQ(a.bodies[0].viscosity, b.bodies[0].viscosity);
  for (const SimulationInfo& info : {a, b}) {
    const BodyInfo& body = info.bodies[0];
    EXPECT_LT(body.youngs_modulus, body.most_youngs_modulus);
    const double h = 0.01, density = static_cast<double>(body.particle_mass) / (h * h * h);
    EXPECT_NEAR(static_cast<double>(body.youngs_modulus * body.elastic_time_step * info.time_step) /
                    (density * region_moment(0.021, h)),
                1, 1e-5);
  }
  EXPECT_NEAR(b.bodies[0].youngs_modulus, 1e6f, 1);
  EXPECT_NEAR(b.bodies[0].most_youngs_modulus, 2.5e6f, 10) << "a default step pulls 1 of 2.5";
  // Where nothing else says how long a second is, a modulus does.
  SolverConfig weightless = in_metres();
  weightless.gravity = {0, 0, 0};
  Simulation still(weightless);
  still.add_body(cube(0.01f), stiff(1e6f));
  EXPECT_EQ(still.info().time_step, b.time_step);
}

TEST(youngs_modulus, that_steps_do_not_carry_is_refused_with_the_step_that_would) {
  SolverConfig config = in_metres();
  config.time_step = 0.001f;
  Simulation s(config);
  const MaterialId material = s.add_material(stiff(1e6f, 0.5f));
  const std::string text = refusal([&] { s.add_body(cube(0.01f), material, "block"); });
  EXPECT_NE(text.find("material.youngs_modulus: 1e+06 is not allowed in body 'block'"), std::string::npos)
      << text;
  const std::size_t at = text.find("solver.time_step to ");
  ASSERT_NE(at, std::string::npos) << text;
  config.time_step = std::stof(text.substr(at + 20));
  EXPECT_GT(*config.time_step, 0.0005f);
  Simulation shorter(config);
  EXPECT_NO_THROW(shorter.add_body(cube(0.01f), stiff(1e6f, 0.5f)));
  // Of a body that there is, its material or its alpha may not become what steps do not carry.
  const MaterialId there = shorter.material(BodyId{0});
  EXPECT_NE(refusal([&] { shorter.set_material(there, stiff(2e6f, 0.5f)); }), "nothing");
  EXPECT_NE(refusal([&] { shorter.set_alpha(there, 0.0f); }), "nothing");
  EXPECT_NO_THROW(shorter.set_material(there, stiff(1e5f, 0.5f)));
  EXPECT_NEAR(shorter.info().bodies[0].youngs_modulus, 1e5f, 1);
}

TEST(youngs_modulus, is_not_given_beside_elastic_time_step) {
  Material material = stiff(1e4f);
  material.elastic_time_step = 0.01f;
  Simulation s(in_metres());
  EXPECT_NE(refusal([&] { s.add_material(material); }).find("give one of the two"), std::string::npos);
}

/// Δt0 that follows, of a cube whose first particle has so many times the modulus and an alpha.
float chosen_step(const SolverConfig& config, const Material& material, std::optional<float> stiffness,
                  std::optional<float> alpha = {}) {
  Body body = cube(0.01f);
  if (stiffness) {
    body.stiffness.assign(body.positions.size(), 1.0f);
    body.stiffness.front() = *stiffness;
  }
  if (alpha) {
    body.alpha.assign(body.positions.size(), material.alpha.lowest());
    body.alpha.front() = *alpha;
  }
  Simulation s(config);
  s.add_body(body, material);
  s.step();
  return s.info().time_step;
}

TEST(youngs_modulus, that_particles_have_more_of_makes_the_step_as_short_as_one_of_the_material) {
  for (const Quality quality : qualities()) {
    const SolverConfig config = with_quality(in_metres(), quality);
    for (const float times : {1.5f, 4.0f, 30.0f})
      EXPECT_FLOAT_EQ(chosen_step(config, stiff(1e5f, 0.1f), times),
                      chosen_step(config, stiff(1e5f * times, 0.1f), {}))
          << times << ' ' << name(quality);
    EXPECT_FLOAT_EQ(chosen_step(config, stiff(1e5f, 0.9f), {}, 0.1f),
                    chosen_step(config, stiff(1e5f, 0.1f), {}))
        << name(quality);
  }
}

TEST(youngs_modulus, that_no_particle_has_more_of_leaves_the_step_as_it_is) {
  for (const float alpha : {0.0f, 0.1f, 0.4f, 0.7f}) {
    const float step = chosen_step(in_metres(), stiff(1e5f, alpha), {});
    EXPECT_EQ(chosen_step(in_metres(), stiff(1e5f, alpha), 1.0f), step) << alpha;
    EXPECT_EQ(chosen_step(in_metres(), stiff(1e5f, alpha), 0.2f), step) << alpha;
    Material melts = stiff(1e5f, alpha);
    melts.temperature = 300.0f;
    melts.alpha_by_temperature = Schedule{{290, alpha}, {310, 1}};
    EXPECT_EQ(chosen_step(in_metres(), melts, {}), step) << alpha;
  }
}

TEST(youngs_modulus, names_the_factor_on_steps_that_makes_them_too_long) {
  SolverConfig config = in_metres();
  config.time_step = 0.001f;
  config.time_step_factor = 3;
  const std::string text = refusal([&] {
    Simulation s(config);
    s.add_body(cube(0.01f), stiff(1e5f));
  });
  const std::string words = "solver.time_step_factor (now 3) to ";
  ASSERT_NE(text.find(words), text.npos) << text;
  config.time_step_factor = std::stof(text.substr(text.find(words) + words.size()));
  EXPECT_EQ(refusal([&] {
              Simulation s(config);
              s.add_body(cube(0.01f), stiff(1e5f));
            }),
            "nothing");
}

TEST(youngs_modulus, stays_at_any_quality) {
  for (const Quality quality : qualities()) {
    const Material material = with_quality(stiff(1e5f), in_metres(), quality);
    Simulation s(with_quality(in_metres(), quality));
    s.add_body(cube(0.01f), material);
    EXPECT_NEAR(s.info().bodies[0].youngs_modulus, 1e5f, 1) << name(quality);
  }
}

TEST(youngs_modulus, is_of_each_body_and_outlives_a_saved_state) {
  Simulation s(in_metres(0.02f));
  const MaterialId material = s.add_material(stiff(2e4f, 0.1f));
  s.add_body(cube(0.01f, {0, 0, 0.01f}), material);
  s.add_body(cube(0.02f, {0.2f, 0, 0.01f}), material);
  s.add_emitter({.radius = 0.02f, .spacing = 0.01f, .pose = {.translation = {-0.2, 0, 0.2}}, .speed = 0.2f},
                material);
  s.add_collider({.shape = Plane{}});
  for (int k = 0; k < 20; ++k) s.step();
  const SimulationInfo info = s.info();
  for (const BodyInfo& body : info.bodies) EXPECT_NEAR(body.youngs_modulus, 2e4f, 1) << body.name;
  EXPECT_GT(info.bodies[0].elastic_time_step, 0);
  EXPECT_NE(info.bodies[0].elastic_time_step, info.bodies[1].elastic_time_step);
  Simulation again = Simulation::restore(s.save());
  for (int k = 0; k < 20; ++k) {
    s.step();
    again.step();
  }
  EXPECT_EQ(again.state_hash(), s.state_hash());
}

}  // namespace stiffness_test
}  // namespace mallow

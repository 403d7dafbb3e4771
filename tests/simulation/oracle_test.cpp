#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "mallow/simulation.h"
#include "oracle/oracle.h"
#include "simulation/oracle_cases.h"

namespace mallow {
namespace oracle_test {

using oracle::Oracle;
using oracle::Vec;

constexpr int k_steps = 40;
/// What everything in a case must do to some position at least, in units of h.
constexpr double k_significant = 0.05;

/// as_bodies: what joins the one before is a body of its own that merges with it.
Simulation engine_of(const Case& scene, bool as_bodies = false) {
  Simulation engine(scene.solver);
  BodyId last{};
  for (const Blob& blob : scene.blobs) {
    const Body points{.positions = points_of(blob),
                      .spacing = blob.spacing,
                      .velocity = blob.velocity,
                      .alpha = alphas_of(blob),
                      .plastic_yield = yields_of(blob),
                      .stiffness = stiffnesses_of(blob),
                      .merges = as_bodies,
                      .splits = blob.splits};
    if (!blob.joins_the_one_before)
      last = engine.add_body(points, blob.material);
    else if (as_bodies)
      engine.add_body(points, engine.material(last));
    else
      engine.extend_body(last, points);
  }
  for (const Collider& collider : scene.colliders) engine.add_collider(collider);
  for (const Pinned& pin : scene.pins) engine.pin(pin.box, pin.velocity);
  for (const Nozzle& nozzle : scene.nozzles)
    engine.add_emitter(nozzle.emitter, engine.add_material(nozzle.material));
  for (const Drain& drain : scene.drains) engine.add_sink(drain.box, drain.outside);
  if (scene.wind) {
    engine.set_force([](const ForceInput& input, VectorSpan accelerations) {
      for (std::size_t row = 0; row < input.ids.size(); ++row) {
        accelerations.eigen().row(static_cast<Eigen::Index>(row)) +=
            wind<float>(input.time, input.ids[row], input.positions[row], input.velocities[row]).transpose();
      }
    });
  }
  return engine;
}

PlacesById places_of(const Simulation& engine) {
  PlacesById places;
  for (std::size_t row = 0; row < engine.particle_count(); ++row)
    places[engine.ids()[row]] = engine.positions()[row].cast<double>();
  return places;
}

bool same_ids(const PlacesById& a, const PlacesById& b) {
  return std::ranges::equal(a, b, {}, &PlacesById::value_type::first, &PlacesById::value_type::first);
}

/// The largest difference of a temperature from its twin's [K].
double largest_warming(const Oracle& oracle, const Simulation& engine) {
  double largest = 0;
  const std::span<const float> temperatures = engine.temperatures();
  std::map<std::size_t, double> expected;
  for (const oracle::Particle& p : oracle.particles()) expected[p.id] = p.temperature;
  for (std::size_t row = 0; row < temperatures.size(); ++row)
    largest = std::max(largest, std::abs(expected[engine.ids()[row]] - double{temperatures[row]}));
  return largest;
}

void expect_match(const Case& scene, Simulation& engine) {
  Oracle oracle = oracle_of(scene);
  for (int c = 0; c < k_steps; ++c) {
    const oracle::Step expected = oracle.step();
    const StepReport report = engine.step();
    ASSERT_NEAR(report.time_step / expected.time_step, 1, 1e-4) << "step " << c;
    ASSERT_EQ(static_cast<std::size_t>(report.updated_references), expected.updated_groups.size())
        << "step " << c;
    ASSERT_EQ(report.volume_iterations, expected.volume_iterations) << "step " << c;
  }
  const PlacesById expected = mallow::places_of(oracle), got = places_of(engine);
  ASSERT_TRUE(same_ids(expected, got));
  const double deviation = largest_deviation(scene, expected, got);
  testing::Test::RecordProperty("deviation_in_spacings", std::to_string(deviation));
  EXPECT_LE(deviation, scene.tolerance) << "in units of h";
  const double warming = largest_warming(oracle, engine);
  testing::Test::RecordProperty("temperature_off", std::to_string(warming));
  EXPECT_LE(warming, 1e-3) << "K";
}

class oracle_case : public testing::TestWithParam<Case> {};

TEST_P(oracle_case, engine_matches_the_oracle) {
  Simulation engine = engine_of(GetParam());
  expect_match(GetParam(), engine);
}

// Until they touch they share no region: so far apart two lumps of one body are to each other what two bodies
// are. They may melt, one day: else they would touch as bodies do before they are one.
TEST(oracle, is_matched_by_two_bodies_that_become_one) {
  const std::vector<Case> cases = oracle_cases();
  const auto found = std::ranges::find(cases, "two_lumps_of_dough_merge", &Case::name);
  ASSERT_NE(found, cases.end());
  Case lumps = *found;
  lumps.blobs[0].material.alpha = {{1e4f, 0.4f}, {2e4f, 1.0f}};
  lumps.blobs[0].material.tear_strain = 5;  // whether a blow strains half of it is asked of each body by itself
  lumps.blobs[1].center.z() += 1.2f;
  lumps.blobs[1].velocity.z() = -3;
  Simulation engine = engine_of(lumps, true);
  EXPECT_EQ(engine.body_count(), 2u);
  expect_match(lumps, engine);
  EXPECT_EQ(engine.body_count(), 1u);
}

TEST_P(oracle_case, everything_in_it_matters) {
  const Case& scene = GetParam();
  Oracle whole = oracle_of(scene);
  int updates = 0;
  bool limited = false;
  for (int c = 0; c < k_steps; ++c) {
    const oracle::Step step = whole.step();
    updates += static_cast<int>(step.updated_groups.size());
    limited = limited || (scene.solver.time_step && step.time_step < double{*scene.solver.time_step});
  }
  EXPECT_GE(updates, scene.updates);
  EXPECT_TRUE(limited || !scene.limited);
  for (const Case& less : ablations(scene)) {
    Oracle lesser = oracle_of(less);
    for (int c = 0; c < k_steps; ++c) lesser.step();
    const PlacesById with = mallow::places_of(whole), without = mallow::places_of(lesser);
    if (!same_ids(with, without)) continue;  // what a sink takes follows from all
    EXPECT_GE(largest_deviation(scene, with, without), k_significant) << less.name;
  }
}

INSTANTIATE_TEST_SUITE_P(scenes, oracle_case, testing::ValuesIn(oracle_cases()),
                         [](const auto& scene) { return scene.param.name; });

}  // namespace oracle_test
}  // namespace mallow

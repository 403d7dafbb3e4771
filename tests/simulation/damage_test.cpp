// Numbers that are not finite, put into any column of a simulation behind the phase that writes it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mallow/mallow.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {

/// The way of tests to the columns of a simulation.
struct StateAccess {
  static Simulation::State& of(Simulation& s) { return *s.state_; }
};

namespace damage_test {

constexpr float k_infinity = std::numeric_limits<float>::infinity();

/// A jelly of alpha 0.6 between two others, with viscosity, contact, updates, a callback and kept lists.
Simulation make(int stride = 1, float slack = 0) {
  Simulation s({.time_step = 0.1f,
                .support_radius = 2.9f,
                .gravity = {0, 0, -0.5f},
                .update_interval = 3,
                .contact = BodyContact::pressure,
                .neighbor_slack = slack,
                .threads = 2});
  const auto cube = [](float height) {
    return sample(Lattice{.count = {7, 8, 5}, .spacing = 1.0f, .corner = {0, 0, height}, .jitter = 0});
  };
  const Material jelly{.alpha = 0.6f, .update_threshold = 0.1f, .viscosity = 0.5f, .region_stride = stride};
  s.add_body(cube(0.5f), {.alpha = 0, .region_stride = stride});
  s.add_body(cube(6.0f), jelly);
  s.add_body(cube(11.5f), {.alpha = 1});
  s.add_collider({.shape = Plane{}});
  s.set_force([](const ForceInput&, VectorSpan a) { a.y()[5] += 0.1f; });
  return s;
}

/// A column of a simulation and how to find what is whose in it.
struct Target {
  std::string name;
  Phase phase;
  std::function<float*(Simulation::State&)> values;
  std::function<std::size_t(Simulation::State&)> size;
  std::function<std::size_t(Simulation::State&, std::size_t)> row_of;
};

Target sorted(std::string name, Phase phase, std::function<float*(Simulation::State&)> values) {
  return {std::move(name), phase, std::move(values), [](Simulation::State& s) { return s.store.size(); },
          [](Simulation::State& s, std::size_t i) { return std::size_t{s.sph.grid.order[i]}; }};
}
Target by_row(std::string name, Phase phase, std::function<float*(Simulation::State&)> values) {
  return {std::move(name), phase, std::move(values), [](Simulation::State& s) { return s.store.size(); },
          [](Simulation::State&, std::size_t i) { return i; }};
}
ShapeMatching& jelly(Simulation::State& s) {
  return s.bodies[1].shape;
}
Target of_particles(std::string name, Phase phase, std::function<float*(Simulation::State&)> values) {
  return {std::move(name), phase, std::move(values),
          [](Simulation::State& s) { return jelly(s).reference.size(); },
          [](Simulation::State& s, std::size_t i) { return s.bodies[1].begin + i; }};
}
Target of_regions(std::string name, Phase phase, std::function<float*(Simulation::State&)> values) {
  return {std::move(name), phase, std::move(values),
          [](Simulation::State& s) { return jelly(s).region_weight.size(); },
          [](Simulation::State& s, std::size_t j) { return s.bodies[1].begin + jelly(s).first_row(j); }};
}

/// Every column of floats that some later phase reads.
std::vector<Target> targets() {
  using S = Simulation::State;
  std::vector<Target> all;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = std::string(" ") + "xyz"[a];
    all.push_back(by_row("position" + axis, Phase::motion, [=](S& s) { return s.store.position.axis(a); }));
    all.push_back(by_row("velocity" + axis, Phase::motion, [=](S& s) { return s.store.velocity.axis(a); }));
    all.push_back(
        sorted("sorted position" + axis, Phase::neighbors, [=](S& s) { return s.sph.grid.sorted.axis(a); }));
    all.push_back(by_row("acceleration by SPH" + axis, Phase::accelerations,
                         [=](S& s) { return s.sph.acceleration.axis(a); }));
    all.push_back(by_row("acceleration by other bodies" + axis, Phase::accelerations,
                         [=](S& s) { return s.sph.cross_group.axis(a); }));
    all.push_back(by_row("acceleration by the force callback" + axis, Phase::time_step,
                         [=](S& s) { return s.user_acceleration.axis(a); }));
    all.push_back(of_particles("reference position" + axis, Phase::reference_update,
                               [=](S& s) { return jelly(s).reference.axis(a); }));
    all.push_back(of_regions("centre of its region" + axis, Phase::reference_update,
                             [=](S& s) { return jelly(s).center.axis(a); }));
    all.push_back(of_particles("pull" + axis, Phase::goals, [=](S& s) { return jelly(s).pull.axis(a); }));
  }
  all.push_back(sorted("density", Phase::density, [](S& s) { return s.sph.density.data(); }));
  all.push_back(sorted("pressure", Phase::density, [](S& s) { return s.sph.pressure.data(); }));
  all.push_back(sorted("volume", Phase::density, [](S& s) { return s.sph.volume.data(); }));
  all.push_back(of_particles("weight", Phase::reference_update, [](S& s) { return jelly(s).weight.data(); }));
  all.push_back(of_regions("weight of its region", Phase::reference_update,
                           [](S& s) { return jelly(s).region_weight.data(); }));
  for (std::size_t k = 0; k < 6; ++k)
    all.push_back(of_regions("moment of its region", Phase::reference_update,
                             [=](S& s) { return jelly(s).moment[k].data(); }));
  for (std::size_t k = 0; k < 4; ++k)
    all.push_back(of_regions("rotation of its region", Phase::rotations,
                             [=](S& s) { return jelly(s).rotation[k].data(); }));
  for (std::size_t k = 0; k < k_row_sums; ++k) {
    Target sums = of_regions("sum of its region", Phase::region_sums, [](S&) { return nullptr; });
    sums.values = [=](S& s) { return jelly(s).sums.data() + k; };
    all.push_back(sums);
  }
  return all;
}

float& entry(const Target& target, Simulation::State& s, std::size_t i) {
  return target.values(s)[i * (target.name == "sum of its region" ? k_row : 1)];
}

/// What a step does when `value` stands at entry i of a column behind the phase that writes it: nothing, or
/// which particle and phase it names. Columns that outlive the step are seen by the next.
struct Outcome {
  std::optional<std::uint32_t> id;
  std::optional<Phase> phase;
  std::string message;
};

Outcome step_with(Simulation& s, const Target& target, std::size_t i, float value) {
  Simulation::State& state = StateAccess::of(s);
  float kept = 0;
  float* place = nullptr;
  const auto damage = [&] {
    place = &entry(target, state, i);
    kept = std::exchange(*place, value);
  };
  const bool lasts = target.phase == Phase::motion || target.phase == Phase::rotations;
  if (lasts) damage();
  const PhaseHook hook = [&](Phase phase) {
    if (!lasts && phase == target.phase) damage();
  };
  Outcome outcome;
  try {
    s.prepare();
    take_step(state, k_infinity, hook);
  } catch (const StepError& error) {
    outcome = {error.particle_id(), error.phase(), error.what()};
  }
  if (outcome.id) *place = kept;
  return outcome;
}

class damage : public testing::TestWithParam<std::tuple<int, float>> {};

TEST_P(damage, in_any_column_is_found_in_that_step_and_named_by_particle_and_phase) {
  const auto [stride, slack] = GetParam();
  Simulation s = make(stride, slack);
  for (int k = 0; k < 5; ++k) s.step();
  Simulation::State& state = StateAccess::of(s);
  const SavedState before = s.save();
  const std::uint64_t hash = s.state_hash();
  for (const Target& target : targets()) {
    const std::size_t n = target.size(state);
    for (const std::size_t i : {std::size_t{0}, n / 2 + 3, n - 1})
      for (const float value : {std::nanf(""), k_infinity, -k_infinity}) {
        SCOPED_TRACE(target.name + " " + std::to_string(i) + " " + std::to_string(value));
        const ParticleId id = state.store.id[target.row_of(state, i)];
        const Outcome outcome = step_with(s, target, i, value);
        ASSERT_TRUE(outcome.id.has_value()) << "the step was taken";
        EXPECT_EQ(*outcome.id, id) << outcome.message;
        EXPECT_EQ(*outcome.phase, target.phase) << outcome.message;
        EXPECT_NE(outcome.message.find(target.name.substr(0, target.name.find_last_not_of(" xyz") + 1)),
                  std::string::npos)
            << outcome.message;
        EXPECT_EQ(s.state_hash(), hash);
      }
  }
  // The last good state is whole: it goes on as if nothing had been.
  Simulation twin = Simulation::restore(before, 2);
  twin.set_force([](const ForceInput&, VectorSpan a) { a.y()[5] += 0.1f; });
  for (int k = 0; k < 20; ++k) {
    s.step();
    twin.step();
  }
  const std::vector<Vec3> x = s.positions_by_id(), y = twin.positions_by_id();
  for (std::size_t id = 0; id < x.size(); ++id) ASSERT_LT((x[id] - y[id]).norm(), 1e-5f) << id;
}

INSTANTIATE_TEST_SUITE_P(scenes, damage,
                         testing::Values(std::tuple{1, 0.0f}, std::tuple{3, 0.0f}, std::tuple{1, 0.2f}));

TEST(damage, never_gets_into_a_reference_shape) {
  Simulation s = make();
  for (int k = 0; k < 6; ++k) s.step();
  Simulation::State& state = StateAccess::of(s);
  ASSERT_EQ(state.step % *state.config.update_interval, 0);
  ASSERT_GT(state.bodies[1].judged_external, 0.1) << "the next step updates the reference";
  const std::size_t row = state.bodies[1].begin + 7;
  const float kept = std::exchange(state.store.position.y()[row], k_infinity);
  EXPECT_THROW(s.step(), StepError);
  state.store.position.y()[row] = kept;
  EXPECT_EQ(s.step().updated_references, 1);
}

TEST(damage, by_denormals_and_signed_zeros_is_none) {
  for (const float value : {0.0f, -0.0f, 1e-42f, -1e-42f})
    for (const Target& target : targets()) {
      SCOPED_TRACE(target.name + " " + std::to_string(value));
      Simulation s = make();
      for (int k = 0; k < 5; ++k) s.step();
      const std::size_t i = target.size(StateAccess::of(s)) / 2;
      const Outcome outcome = step_with(s, target, i, value);
      if (outcome.id) continue;  // as where a density of nothing pushes without end
      for (const Vec3& x : s.positions_by_id()) ASSERT_TRUE(x.allFinite());
      for (const Vec3& v : s.velocities_by_id()) ASSERT_TRUE(v.allFinite());
    }
}

}  // namespace damage_test
}  // namespace mallow

// Simulation::set_solver(): what may change while a simulation runs, and what that does.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace solver_changes_test {

using test::refusal;

const SolverConfig k_config{.support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 1};

/// A cube above a floor, under way.
Simulation falling(const SolverConfig& config = k_config) {
  Simulation simulation(config);
  simulation.add_body(sample(Lattice{.count = {5, 5, 5}, .corner = {0, 0, 1}, .jitter = 0}),
                      Material{.alpha = 0.5f});
  simulation.add_collider({.shape = Plane{}});
  for (int k = 0; k < 10; ++k) simulation.step();
  return simulation;
}

std::uint64_t after(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
  return simulation.state_hash();
}

TEST(set_solver, of_what_is_set_already_changes_no_bit) {
  Simulation plain = falling(), set = falling();
  set.set_solver(set.config());
  EXPECT_EQ(set.state_hash(), plain.state_hash());
  EXPECT_EQ(after(set, 40), after(plain, 40));
}

TEST(set_solver, refuses_what_a_simulation_was_made_with_and_changes_nothing) {
  Simulation plain = falling(), asked = falling();
  const std::vector<std::pair<std::string, std::function<void(SolverConfig&)>>> kept{
      {"solver.support_radius", [](SolverConfig& c) { c.support_radius = 2.2f; }},
      {"solver.time_step", [](SolverConfig& c) { c.time_step = 1e-4; }},
      {"solver.threads", [](SolverConfig& c) { c.threads = 2; }},
  };
  for (const auto& [name, change] : kept) {
    SolverConfig config = asked.config();
    change(config);
    const std::string said = refusal([&] { asked.set_solver(config); });
    EXPECT_NE(said.find(name), std::string::npos) << said;
    EXPECT_NE(said.find("cannot change while a simulation runs"), std::string::npos) << said;
  }
  SolverConfig wrong = asked.config();
  wrong.time_step_factor = -1;
  wrong.gravity = {1, 2, 3};
  EXPECT_NE(refusal([&] { asked.set_solver(wrong); }).find("solver.time_step_factor"), std::string::npos);
  EXPECT_EQ(asked.config().gravity, k_config.gravity);
  EXPECT_EQ(after(asked, 40), after(plain, 40));
}

TEST(set_solver, halves_steps_by_half_the_factor) {
  Simulation simulation = falling();
  const double before = simulation.step().time_step;
  SolverConfig config = simulation.config();
  config.time_step_factor *= 0.5f;
  simulation.set_solver(config);
  EXPECT_FLOAT_EQ(static_cast<float>(simulation.step().time_step), static_cast<float>(before / 2));
}

TEST(set_solver, turns_gravity_from_the_next_step_on) {
  Simulation simulation = falling();
  const BodyId body = simulation.bodies().front();
  SolverConfig config = simulation.config();
  config.gravity = {0.3f, 0, 0};
  const Eigen::Vector3d before = simulation.motion(body).momentum;
  simulation.set_solver(config);
  const double seconds = simulation.step().time_step;
  const BodyMotion motion = simulation.motion(body);
  const Eigen::Vector3d gained = (motion.momentum - before) / motion.mass;
  EXPECT_NEAR(gained.x(), 0.3 * seconds, 1e-3 * 0.3 * seconds);
  EXPECT_NEAR(gained.z(), 0, 1e-3 * 0.3 * seconds);
}

TEST(set_solver, leaves_what_the_first_prepare_settled) {
  Simulation simulation = falling();
  const SimulationInfo before = simulation.info();
  SolverConfig config = simulation.config();
  config.gravity = {0, 0, -30};
  simulation.set_solver(config);
  simulation.prepare();
  EXPECT_EQ(simulation.info().bodies[0].update_threshold, before.bodies[0].update_threshold);
  EXPECT_EQ(simulation.info().bodies[0].pressure_coefficient, before.bodies[0].pressure_coefficient);
}

TEST(set_solver, is_kept_by_a_saved_state) {
  Simulation simulation = falling();
  SolverConfig config = simulation.config();
  config.time_step_factor = 0.5f;
  config.gravity = {0.1f, 0, -0.2f};
  simulation.set_solver(config);
  after(simulation, 5);
  Simulation restored = Simulation::restore(simulation.save(), 1);
  EXPECT_EQ(restored.config().gravity, config.gravity);
  EXPECT_EQ(after(restored, 40), after(simulation, 40));
}

}  // namespace solver_changes_test
}  // namespace mallow

#include "materials/standard_tests.h"

#include <chrono>
#include <cmath>

#include "harness/command.h"
#include "mallow/scene.h"

namespace mallow::bench {
namespace {

constexpr double k_side = 0.1;                            // of the cubes [m]
constexpr double k_drop_end = 1.5, k_slope_end = 0.5;     // [s]
constexpr double k_held_from = 0.85, k_held_until = 0.9;  // of the squeeze [s]
constexpr double k_released = 1.8, k_strain = 0.2;

/// Mean of value(x) over all particles.
template <class Value>
double mean(const Simulation& simulation, const Value& value) {
  const VectorView x = simulation.positions();
  double sum = 0;
  for (std::size_t row = 0; row < simulation.particle_count(); ++row) sum += value(x[row].cast<double>());
  return sum / static_cast<double>(simulation.particle_count());
}

double mean_along(const Simulation& simulation) {
  return mean(simulation, [](const Eigen::Vector3d& x) { return x.x(); });
}

/// Twice that of its middle, which says the height of a block and depends on no single particle.
double height(const Simulation& simulation) {
  return 2 * mean(simulation, [](const Eigen::Vector3d& x) { return x.z(); });
}

std::vector<Measured> drop(Simulation& simulation) {
  simulation.advance(k_drop_end);
  const double square = mean(simulation, [](const Eigen::Vector3d& x) { return x.head<2>().squaredNorm(); });
  return {{"height [m]", height(simulation)}, {"mean radius [m]", std::sqrt(square)}};
}

/// modulus: E, which theory takes for all of the stress: pressure, where it acts, adds to it.
std::vector<Measured> squeeze(Simulation& simulation, double modulus, bool is_elastic) {
  simulation.advance(k_held_from);
  double impulse = 0;
  while (simulation.time() < k_held_until) {
    simulation.step_towards(k_held_until);
    impulse += std::abs(static_cast<double>(simulation.load(ColliderId{1}).impulse.z()));
  }
  const double stress = impulse / (k_held_until - k_held_from) / (k_side * k_side);
  simulation.advance(k_released - simulation.time());
  Measured held{"stress held [Pa]", stress};
  if (is_elastic) held.theory = modulus * k_strain;
  return {held, {"set, share of the height", 1 - height(simulation) / k_side}};
}

std::vector<Measured> slide(Simulation& simulation, const Scene& scene) {
  const double before = mean_along(simulation);
  simulation.advance(k_slope_end);
  const double friction = static_cast<double>(scene.colliders[0].friction);
  const Eigen::Vector3d gravity = scene.solver.gravity.cast<double>();
  const double rigid = 0.5 * (gravity.x() + friction * gravity.z()) * k_slope_end * k_slope_end;
  return {{"slid [m]", mean_along(simulation) - before, rigid}, {"height [m]", height(simulation)}};
}

Scene scene_of(const StandardTest& test) {
  const std::string name = "scenes/standard/" + test.scene + ".toml";
  const int side = 10 * test.refined;
  const std::string count = std::to_string(side);
  Scene scene =
      read_scene(data_file(name),
                 std::vector<std::string>{"body[0].material=\"" + test.material + '"',
                                          "body[0].box.count=[" + count + ',' + count + ',' + count + ']',
                                          "body[0].box.spacing=" + std::to_string(k_side / side)});
  for (SceneCollider& collider : scene.colliders) collider.measure_load = true;
  return scene;
}

}  // namespace

TestRun run(const StandardTest& test) {
  const auto start = std::chrono::steady_clock::now();
  const Scene scene = scene_of(test);
  Simulation simulation = build(scene, test.threads);
  const SimulationInfo info = simulation.info();
  const BodyInfo& body = info.bodies.front();
  const Material& material = scene.materials.front().material;
  const bool keeps = body.alpha < 1 && !material.update_threshold && !material.plastic_yield;
  const double modulus = static_cast<double>((1 - body.alpha) * body.youngs_modulus);
  TestRun result{.spacing = static_cast<double>(body.spacing),
                 .time_step = static_cast<double>(info.time_step),
                 .measured = test.scene == "drop"      ? drop(simulation)
                             : test.scene == "squeeze" ? squeeze(simulation, modulus, keeps)
                                                       : slide(simulation, scene)};
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace mallow::bench

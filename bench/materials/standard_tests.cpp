#include "materials/standard_tests.h"

#include <chrono>
#include <cmath>

#include "harness/command.h"
#include "mallow/scene.h"

namespace mallow::bench {
namespace {

constexpr double k_side = 0.1;                         // of the cubes [m]
constexpr double k_drop_end = 1.5, k_slope_end = 0.5;  // [s]
constexpr double k_rebound_end = 0.6;  // before the second rebound is as high as the first [s]
constexpr double k_bounces_from = 1;   // what still bounces is seen from then on [s]
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

/// About its own middle: a block that bounces rolls away.
struct Extent {
  double height;  ///< of a block that is as spread along z, a spacing for one layer, however it lies [m]
  double radius;  ///< root of the mean square of distances from the vertical through its middle [m]
};
Extent extent(const Simulation& simulation, double spacing) {
  const Eigen::Vector3d middle(mean_along(simulation),
                               mean(simulation, [](const Eigen::Vector3d& x) { return x.y(); }),
                               0.5 * height(simulation));
  const auto square = [&](int axis) {
    return mean(simulation, [&](const Eigen::Vector3d& x) { return std::pow(x[axis] - middle[axis], 2); });
  };
  return {std::sqrt(12 * square(2) + spacing * spacing), std::sqrt(square(0) + square(1))};
}

/// What still bounces at the end is compared by what it does at no instant, which is its phase: how low it
/// is pressed, how high its middle comes in the first rebound, and the mean of its extent in the last half
/// second. Of what lies, its extent is that at the end.
std::vector<Measured> drop(Simulation& simulation, bool is_elastic, double spacing) {
  double lowest = height(simulation), rebound = 0;
  while (simulation.time() < k_rebound_end) {
    simulation.step_towards(k_rebound_end);
    const double now = height(simulation);
    if (now < lowest) rebound = lowest = now;
    rebound = std::max(rebound, now);
  }
  if (!is_elastic) {
    simulation.advance(k_drop_end - simulation.time());
    return {{"height [m]", height(simulation)}, {"mean radius [m]", extent(simulation, spacing).radius}};
  }
  simulation.advance(k_bounces_from - simulation.time());
  Extent sum{0, 0};
  const double begin = simulation.time();
  while (simulation.time() < k_drop_end) {
    const double before = simulation.time();
    simulation.step_towards(k_drop_end);
    const Extent now = extent(simulation, spacing);
    const double share = (simulation.time() - before) / (k_drop_end - begin);
    sum.height += share * now.height, sum.radius += share * now.radius;
  }
  return {{"height [m]", sum.height},
          {"mean radius [m]", sum.radius},
          {"pressed to [m]", lowest},
          {"rebound of the middle [m]", 0.5 * rebound}};
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
                 .measured = test.scene == "drop" ? drop(simulation, keeps, static_cast<double>(body.spacing))
                             : test.scene == "squeeze" ? squeeze(simulation, modulus, keeps)
                                                       : slide(simulation, scene)};
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace mallow::bench

#include "stability/grid.h"

#include <cmath>
#include <numbers>

namespace mallow::bench {
namespace {

/// The paper's.
constexpr float k_time_step = 0.15f, k_update_threshold = 12;
constexpr int k_update_interval = 60;
/// Particles along a side, and their lowest height in spacings.
constexpr int k_side = 6;
constexpr float k_height = 1.5f;
/// How far the stirring moves a particle in a step, in spacings: as much as a body does that is thrown about.
constexpr float k_stir = 0.03f;

}  // namespace

StabilityGrid full_grid() {
  StabilityGrid grid;
  for (int a = 0; a <= 10; ++a) grid.alphas.push_back(static_cast<float>(a) / 10);
  grid.time_steps = {1e-4f, 1e-3f, 1e-2f, 0.1f, 0.5f, 1, 2, 5, 10};
  grid.pressures = {0, 1, 16, 100, 1e3f, 1e4f, 1e5f, 1e6f};
  grid.viscosities = {0, 0.5f, 10, 100, 1e3f, 1e4f};
  grid.restitutions = {0, 0.5f, 1};
  return grid;
}

StabilityGrid thin_grid() {
  return {.alphas = {0, 0.5f, 1},
          .time_steps = {1e-4f, 1, 10},
          .pressures = {0, 16, 1e6f},
          .viscosities = {0, 1e4f},
          .restitutions = {0, 1}};
}

GridPoint grid_point(const StabilityGrid& grid, std::size_t index) {
  const auto take = [&](const std::vector<float>& axis) {
    const float value = axis[index % axis.size()];
    index /= axis.size();
    return value;
  };
  GridPoint point{};
  point.restitution = take(grid.restitutions);
  point.viscosity = take(grid.viscosities);
  point.pressure = take(grid.pressures);
  point.time_step = take(grid.time_steps);
  point.alpha = take(grid.alphas);
  return point;
}

Trial falling_cube(const GridPoint& point, int steps) {
  Trial trial;
  trial.steps = steps;
  trial.floor = 0;
  trial.energy_room = 0.02;
  trial.by_conserved_energy = true;
  trial.build = [point] {
    SolverConfig config;
    config.time_step = k_time_step * point.time_step;
    config.update_interval = k_update_interval;
    config.support_radius = 2.1f;
    config.threads = 1;
    Simulation simulation(config);
    simulation.add_collider({.shape = Plane{}, .restitution = point.restitution, .friction = 0.3f});
    Body cube = sample(Lattice{.count = {k_side, k_side, k_side}, .corner = {0, 0, k_height}, .jitter = 0});
    for (const Vec3& x : cube.positions) {
      const auto wave = [](float c) { return std::sin(2 * std::numbers::pi_v<float> * c / k_side); };
      cube.velocities.push_back(k_stir / *config.time_step * Vec3(wave(x.y()), wave(x.z()), wave(x.x())));
    }
    simulation.add_body(cube, {.alpha = point.alpha,
                               .update_threshold = k_update_threshold,
                               .pressure_coefficient = point.pressure,
                               .viscosity = point.viscosity});
    return simulation;
  };
  return trial;
}

}  // namespace mallow::bench

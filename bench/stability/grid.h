#pragma once

#include <vector>

#include "stability/trial.h"

namespace mallow::bench {

/// Axes of the map of stability. `thin` takes every few values of each.
struct StabilityGrid {
  std::vector<float> alphas;        ///< 0, 0.1, ... 1
  std::vector<float> time_steps;    ///< in units of the paper's Δt0
  std::vector<float> pressures;     ///< k [m²/s²]
  std::vector<float> viscosities;   ///< μ [Pa s]
  std::vector<float> restitutions;  ///< e of the floor
  std::size_t size() const {
    return alphas.size() * time_steps.size() * pressures.size() * viscosities.size() * restitutions.size();
  }
};
StabilityGrid full_grid();
StabilityGrid thin_grid();

/// One point of a grid: e fastest, then μ, k, time step, alpha.
struct GridPoint {
  float alpha, time_step, pressure, viscosity, restitution;
};
GridPoint grid_point(const StabilityGrid& grid, std::size_t index);

/// A cube of 6³ particles, stirred, that falls onto a floor; judged by the energy that the step conserves.
Trial falling_cube(const GridPoint& point, int steps);

}  // namespace mallow::bench

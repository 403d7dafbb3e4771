#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mallow/simulation.h"
#include "stability/extremes.h"

namespace mallow::bench {

/// What most extremes start from, and change one thing of: a small body in the default units.
struct Setup {
  SolverConfig config{
      .time_step = 0.15f, .support_radius = 2.1f, .update_interval = 60, .sleep_speed = 0.0f, .threads = 1};
  Material material{.update_threshold = 12.0f, .pressure_coefficient = 16.0f, .viscosity = 0.5f};
  Body body = sample(Lattice{.count = {5, 5, 5}, .corner = {0, 0, 1}, .jitter = 0});
  std::vector<Collider> colliders = {};
  /// A second body, of `material` but for its mass.
  Body other = {};
  float other_mass = 1;

  Simulation build() const;
};

/// Without an outside.
Setup free_body();
/// Onto a floor.
Setup falling_body();
/// Two that come together, without an outside.
Setup two_bodies(float speed);

/// Velocities that twist and stretch, as large as they say.
void stir(Setup& setup, float velocity);
/// To be called before a step: from a nozzle above the body.
void pour_a_layer_a_step(Simulation& simulation, int step);

/// The trial that pushes this setup: what it says of its bodies is filled in.
Trial trial_of(const Setup& setup, Trial trial);

using Change = std::function<void(Setup&)>;
/// Of a solid, a paste and a fluid, whose alpha `change` finds.
void add_extremes(const std::string& name, const Setup& base, const Change& change, const Trial& trial,
                  std::vector<Extreme>& list);

}  // namespace mallow::bench

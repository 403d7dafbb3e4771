#include "stability/panels.h"

#include <algorithm>

#include "stability/setup.h"

namespace mallow::bench {
namespace {

using Alter = std::function<void(Setup&, float value)>;

/// Of two bodies that meet without an outside, the energy that a step conserves never grows.
Panel of_two(const std::string& name, std::vector<float> values, float speed, const Alter& alter) {
  return {name, std::move(values), [=](float alpha, float value) {
            Setup setup = two_bodies(speed);
            setup.material.alpha = alpha;
            setup.material.update_threshold = 1e30f;
            alter(setup, value);
            return trial_of(setup, {.energy_room = 0.02, .by_conserved_energy = true});
          }};
}

/// Of one that falls onto a floor. What pushes it, or comes as well, does work: particles stay finite.
Panel of_one(const std::string& name, std::vector<float> values, double energy_room, const Alter& alter,
             const std::function<std::function<void(Simulation&, int)>(float)>& before_step = {}) {
  return {name, std::move(values), [=](float alpha, float value) {
            Setup setup = falling_body();
            setup.material.alpha = alpha;
            alter(setup, value);
            Trial trial{.energy_room = energy_room, .by_conserved_energy = energy_room < 1};
            if (before_step) trial.before_step = before_step(value);
            return trial_of(setup, trial);
          }};
}

/// So many small bodies a step are thrown onto what lies there, the oldest go.
void spawn(Simulation& simulation, int step, float a_step) {
  const int many = static_cast<int>(a_step * static_cast<float>(step + 1)) -
                   static_cast<int>(a_step * static_cast<float>(step));
  for (int k = 0; k < many; ++k) {
    Body body = sample(Lattice{
        .count = {2, 2, 2},
        .corner = {7.0f * static_cast<float>((step + k) % 4 - 1), 4.0f * static_cast<float>(k % 8), 9},
        .jitter = 0});
    body.velocity = {0, 0, -10};
    if (simulation.bodies().size() > 40) simulation.remove_body(simulation.bodies()[1]);
    try {
      simulation.add_body(body, MaterialId{0});
    } catch (const ConfigError&) {  // something is still there
    }
  }
}

void pour(Simulation& simulation, int step, float speed) {
  if (step > 0) return;
  const Pose down{.translation = {2.5f, 2.5f, 40}, .rotation = {1, 0, 0, 0}};
  simulation.add_emitter({.radius = 2.0f, .pose = down, .speed = speed, .most_particles = 800},
                         MaterialId{0});
}

void hit_by_a_ball(Setup& s, float spacings_a_step) {
  const float v = spacings_a_step / 0.15f;
  s.colliders.push_back(
      {.shape = Sphere{.center = {-10 - 3 * v, 2.5f, 3.5f}, .radius = 3}, .velocity = {v, 0, 0}});
}
void stirred_by_a_bar(Setup& s, float turns) {
  s.colliders.push_back(
      {.shape = Box{.min = {-4, -0.5f, 0}, .max = {4, 0.5f, 8}}, .angular_velocity = {0, 0, turns}});
}

}  // namespace

std::vector<Panel> panels() {
  constexpr double k_any = 1e9;
  const auto nothing = [](Setup&, float) {};
  return {
      of_two("head-on speed [h a second]", {0.1f, 1, 5, 14, 40, 140, 400}, 0,
             [](Setup& s, float v) {
               s.body.velocity = {0, 0, v / 2};
               s.other.velocity = {0, 0, -v / 2};
             }),
      of_two("ratio of masses", {1e-4f, 1e-2f, 0.1f, 1, 10, 100, 1e4f}, 2,
             [](Setup& s, float ratio) { s.other_mass = ratio; }),
      of_two("friction between bodies that graze", {0, 0.1f, 0.5f, 1, 2, 10, 1e3f}, 2,
             [](Setup& s, float friction) {
               s.material.friction = friction;
               s.body.velocity.x() = 4;
             }),
      of_two("adhesion [Pa]", {0, 0.1f, 1, 10, 100, 1e4f, 1e6f}, 2,
             [](Setup& s, float adhesion) {
               s.material.adhesion = adhesion;
               s.body.velocity.x() = 1;
             }),
      of_one("deformation_damping [1/s]", {0, 0.1f, 1, 10, 100, 1e3f, 1e5f}, 0.02,
             [](Setup& s, float rate) { s.material.deformation_damping = rate; }),
      of_one("damping_time [s]", {0, 0.01f, 0.05f, 0.1f, 0.2f, 1, 10}, 0.02,
             [](Setup& s, float time) { s.material.damping_time = time; }),
      of_one("bodies that come and go, a step", {0.01f, 0.1f, 0.5f, 1, 2, 4, 8}, k_any, nothing,
             [](float rate) {
               return [rate](Simulation& simulation, int step) { spawn(simulation, step, rate); };
             }),
      of_one("speed of an emitter [h a second]", {0.1f, 1, 3, 6, 12, 60, 600}, k_any, nothing,
             [](float speed) {
               return [speed](Simulation& simulation, int step) { pour(simulation, step, speed); };
             }),
      of_one("a ball that hits [h a step]", {0.01f, 0.1f, 1, 3, 10, 30, 100}, k_any, hit_by_a_ball),
      of_one("a bar that turns [rad/s]", {0.1f, 0.3f, 1, 3, 10, 30, 100}, k_any, stirred_by_a_bar),
  };
}

std::vector<float> panel_alphas(bool thin) {
  return thin ? std::vector<float>{0, 1} : std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1};
}

}  // namespace mallow::bench

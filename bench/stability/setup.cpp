#include "stability/setup.h"

#include <cmath>
#include <numbers>

namespace mallow::bench {

Simulation Setup::build() const {
  Simulation simulation(config);
  for (const Collider& collider : colliders) simulation.add_collider(collider);
  simulation.add_body(body, material);
  if (other.positions.empty()) return simulation;
  Material matter = material;
  matter.particle_mass = other_mass;
  simulation.add_body(other, matter);
  return simulation;
}

Setup free_body() {
  Setup setup;
  setup.config.gravity = Vec3::Zero();
  return setup;
}

Setup falling_body() {
  Setup setup;
  setup.colliders = {{.shape = Plane{}, .friction = 0.3f}};
  return setup;
}

Setup two_bodies(float speed) {
  Setup setup = free_body();
  setup.body.velocity = {0, 0, speed / 2};
  setup.other = sample(Lattice{.count = {5, 5, 5}, .corner = {0.4f, 0.3f, 6.3f}, .jitter = 0});
  setup.other.velocity = {0, 0, -speed / 2};
  return setup;
}

void stir(Setup& setup, float velocity) {
  for (const Vec3& x : setup.body.positions) {
    const auto wave = [](float c) { return std::sin(0.4f * std::numbers::pi_v<float> * c); };
    setup.body.velocities.push_back(velocity * Vec3(wave(x.y()), wave(x.z()), wave(x.x())));
  }
}

void pour_a_layer_a_step(Simulation& simulation, int step) {
  if (step > 0) return;
  const Pose down{.translation = {2.5f, 2.5f, 40}, .rotation = {1, 0, 0, 0}};
  simulation.add_emitter({.radius = 2.0f, .pose = down, .speed = 6, .most_particles = 800}, MaterialId{0});
}

Trial trial_of(const Setup& setup, Trial trial) {
  trial.spacing = setup.body.spacing;
  trial.mass = setup.material.particle_mass.value_or(1.0f);
  trial.other_mass = setup.other_mass;
  if (!setup.other.positions.empty()) trial.other_begin = setup.body.positions.size();
  trial.is_free = setup.config.gravity.isZero() && setup.colliders.empty();
  trial.build = [setup] { return setup.build(); };
  return trial;
}

void add_extremes(const std::string& name, const Setup& base, const Change& change, const Trial& trial,
                  std::vector<Extreme>& list) {
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    Setup setup = base;
    setup.material.alpha = alpha;
    change(setup);
    list.push_back({name, alpha, trial_of(setup, trial)});
  }
}

}  // namespace mallow::bench

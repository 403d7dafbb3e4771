// Extremes of bodies that touch, come and go, and of colliders that move.
#include "stability/catalogue.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mallow::bench {

void Catalogue::bodies_that_touch() {
  Trial trial;
  trial.by_conserved_energy = true;
  trial.energy_room = 0.02;
  const auto add_two = [&](const std::string& name, float speed, const Change& change) {
    add(
        "two bodies " + name, two_bodies(speed),
        [&](Setup& s) {
          s.material.update_threshold = 1e30f;
          change(s);
        },
        trial);
  };
  for (const float speed : {1.0f, 14.0f, 140.0f})
    add_two("head-on at " + std::to_string(static_cast<int>(speed)) + " a second", speed, [](Setup&) {});
  for (const float mass : {1e-3f, 1e2f, 1e4f}) {
    std::ostringstream name;
    name << "of 1 to " << mass << " in mass";
    add_two(name.str(), 2, [=](Setup& s) { s.other_mass = mass; });
  }
  for (const float friction : {0.0f, 2.0f, 1e3f}) {
    std::ostringstream name;
    name << "that graze with friction " << friction;
    add_two(name.str(), 2, [=](Setup& s) {
      s.material.friction = friction;
      s.body.velocity.x() = 4;
    });
  }
  for (const float adhesion : {1.0f, 1e6f}) {
    std::ostringstream name;
    name << "that stick up to " << adhesion;
    add_two(name.str(), 2, [=](Setup& s) {
      s.material.adhesion = adhesion;
      s.body.velocity.x() = 1;
    });
  }
  add_two("of spacings 1 to 3", 4, [](Setup& s) {
    s.other = sample(Lattice{.count = {3, 3, 3}, .spacing = 3, .corner = {-1, -1, 6.6f}, .jitter = 0});
    s.other.velocity = {0, 0, -2};
    s.config.support_radius = 6.3f;
    s.other_mass = 27;
  });
  add_two("in steps of five times the paper's", 2, [](Setup& s) {
    s.config.time_step = 0.75f;
    s.material.elastic_time_step = 0.75f;
  });
  trial.energy_room = 1e9;  // what overlaps is pushed apart
  add_two("half in each other", 0, [](Setup& s) {
    for (Vec3& x : s.other.positions) x.z() -= 2.8f;
  });
  Trial pressed;
  pressed.energy_room = 1e9;  // the plates do work without end
  pressed.steps = 700;
  add(
      "two bodies between plates that close", two_bodies(0),
      [](Setup& s) {
        s.colliders = {{.shape = Plane{}},
                       {.shape = Plane{.normal = {0, 0, -1}, .offset = -13}, .velocity = {0, 0, -0.12f}}};
      },
      pressed);
}

void Catalogue::bodies_that_come_and_go() {
  Trial trial;
  trial.energy_room = 1e3;
  for (const int every : {1, 10}) {
    trial.before_step = [every](Simulation& simulation, int step) {
      if (step % every != 0) return;
      const float x = 7.0f * static_cast<float>(step / every % 4 - 1);
      Body body = sample(Lattice{.count = {2, 2, 2}, .corner = {x, 7, 9}, .jitter = 0});
      body.velocity = {0, 0, -1.5f / 0.15f / static_cast<float>(every)};
      for (const BodyId old : simulation.bodies())
        if (simulation.bodies().size() > 24 && old != simulation.bodies().front()) {
          simulation.remove_body(old);
          break;
        }
      try {
        simulation.add_body(body, MaterialId{0});
      } catch (const ConfigError&) {  // something is still there
      }
    };
    add(
        "a body added and one removed every " + std::to_string(every) + " steps", falling_body(),
        [](Setup&) {}, trial);
  }
  trial.before_step = pour_a_layer_a_step;
  add(
      "an emitter of a layer a step onto a body", falling_body(), [](Setup&) {}, trial);
}

void Catalogue::colliders_that_move() {
  Trial trial;
  trial.energy_room = 1e9;
  for (const float speed : {1.0f, 10.0f, 100.0f})
    add(
        "hit by a ball of " + std::to_string(static_cast<int>(speed)) + " spacings a step", falling_body(),
        [speed](Setup& s) {
          const float v = speed / 0.15f;
          s.colliders.push_back({.shape = Sphere{.center = {-10 - 20 * v * 0.15f, 2.5f, 3.5f}, .radius = 3},
                                 .velocity = {v, 0, 0}});
        },
        trial);
  for (const float turns : {1.0f, 30.0f})
    add(
        "stirred by a bar of " + std::to_string(static_cast<int>(turns)) + " rad a second", falling_body(),
        [turns](Setup& s) {
          s.colliders.push_back(
              {.shape = Box{.min = {-4, -0.5f, 0}, .max = {4, 0.5f, 8}}, .angular_velocity = {0, 0, turns}});
        },
        trial);
}

}  // namespace mallow::bench

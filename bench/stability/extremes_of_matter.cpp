// Extremes of matter that flows, is damped, keeps its volume, is painted or heated.
#include "stability/catalogue.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mallow::bench {
namespace {

constexpr float k_most_damping = 6.3f;  // 6.31 is allowed at alpha 0

/// As long as is allowed, a (1 + 2 τ/Δt) = 2.5 with a = 1 − alpha, of what swings and does not yield.
void damp_longest(Setup& s) {
  const float a = std::max(0.01f, 1 - s.material.alpha.lowest());
  s.material.damping_time = 0.999f * 0.15f * (2.5f / a - 1) / 2;
  s.material.update_threshold = 1e30f;
  stir(s, 0.5f);
}

}  // namespace

void Catalogue::painted_bodies() {
  const auto painted = [](std::vector<float>& column, const Body& body, float left, float right) {
    for (const Vec3& x : body.positions) column.push_back(x.x() < 2.5f ? left : right);
  };
  add_free("alpha 0 beside alpha 1", [&](Setup& s) { painted(s.body.alpha, s.body, 0, 1); });
  add_free("every other particle fluid", [](Setup& s) {
    for (std::size_t i = 0; i < s.body.positions.size(); ++i)
      s.body.alpha.push_back(static_cast<float>(i % 2));
  });
  add_free("a modulus beside a thousandth of it",
           [&](Setup& s) { painted(s.body.stiffness, s.body, 2.5f, 2.5e-3f); });
  add("alpha 0 beside alpha 1, dropped", falling_body(),
      [&](Setup& s) { painted(s.body.alpha, s.body, 0, 1); });
}

void Catalogue::heated_bodies() {
  const auto heated = [](Setup& s, float conductivity) {
    s.material.temperature = 0.0f;
    s.material.conductivity = conductivity;
    s.material.specific_heat = 1;
    s.material.alpha_by_temperature = Schedule{{1, 0}, {100, 1}};
    for (const Vec3& x : s.body.positions) s.body.temperature.push_back(x.x() < 2.5f ? 0.0f : 1e4f);
  };
  for (const float conductivity : {0.01f, 1.0f, 100.0f})
    add_free("10000 K beside 0 K, conductivity " + std::to_string(conductivity),
             [&](Setup& s) { heated(s, conductivity); });
  add("on a plate of 10000 K", falling_body(), [&](Setup& s) {
    heated(s, 1);
    s.colliders[0].temperature = 1e4f;
  });
}

void Catalogue::flow() {
  Trial trial;
  trial.steps = 2000;
  trial.energy_room = 0.02;
  trial.by_conserved_energy = true;
  const auto add_flow = [&](const std::string& name, float yield, std::optional<float> creep,
                            const Change& change) {
    add(
        name, free_body(),
        [&](Setup& s) {
          s.config.update_interval = 10;
          s.material.update_threshold.reset();
          s.material.plastic_yield = yield;
          s.material.plastic_creep = creep;
          s.body = sample(Lattice{.count = {6, 5, 5}, .corner = {0, 0, 1}, .jitter = 0.1f});
          change(s);
          if (s.body.velocities.empty()) stir(s, 2.0f);
        },
        trial);
  };
  for (const float yield : {0.0f, 0.001f, 0.05f, 1.0f}) {
    std::ostringstream name;
    name << "flows from a strain of " << yield;
    add_flow(name.str(), yield, {}, [](Setup&) {});
    add_flow(name.str() + ", as stiff as is allowed", yield, {}, [](Setup& s) {
      s.material.elastic_time_step =
          std::max(0.01f, (1 - s.material.alpha.lowest()) * *s.config.time_step / 2);
    });
  }
  for (const float creep : {1e-6f, 1.0f, 1e9f}) {
    std::ostringstream name;
    name << "creeps at " << creep << " a second";
    add_flow(name.str(), 0.01f, creep, [](Setup&) {});
  }
  add_flow("a layer that flows", 0.01f, {}, [](Setup& s) {
    s.body = sample(Lattice{.count = {8, 8, 1}, .jitter = 0.2f});
  });
  add_flow("two layers that flow", 0.01f, {}, [](Setup& s) {
    s.body = sample(Lattice{.count = {8, 8, 2}, .jitter = 0.2f});
  });
  add_flow("a line that flows", 0.01f, {}, [](Setup& s) {
    s.body = sample(Lattice{.count = {20, 1, 1}, .jitter = 0.2f});
  });
  trial.steps = 500;  // rounding takes spin from what is far away
  add_flow("flows at 20 spacings a second", 0.05f, {}, [](Setup& s) { stir(s, 20.0f); });
  trial.steps = 2000;
  add_flow("flows, in a new frame at every step", 0.01f, {}, [](Setup& s) {
    s.config.update_interval = 1;
    s.material.merge_flow = 0;
    s.material.tear_strain = 0;
  });
  trial.energy_room = 1e9;  // the plates do work without end
  trial.by_conserved_energy = false;
  add(
      "flows between two plates that close", falling_body(),
      [](Setup& s) {
        s.material.plastic_yield = 0.05f;
        s.material.update_threshold.reset();
        s.colliders.push_back(
            {.shape = Plane{.normal = {0, 0, -1}, .offset = -6.5f}, .velocity = {0, 0, -0.1f}});
      },
      trial);
}

void Catalogue::damping() {
  Trial trial;
  trial.by_conserved_energy = true;
  trial.energy_room = 0.02;
  trial.steps = 2000;
  for (const bool both : {false, true})
    add(
        both ? "all damping as much as is allowed" : "a damping time as long as is allowed", falling_body(),
        [&](Setup& s) {
          damp_longest(s);
          if (both) s.material.deformation_damping = k_most_damping;
        },
        trial);
}

void Catalogue::add_kept(const std::string& name, const Setup& base, int iterations, const Change& change,
                         const Trial& trial) {
  add(
      "volume kept, " + name, base,
      [&](Setup& s) {
        s.config.volume_iterations = iterations;
        s.material.pressure_coefficient = {};
        change(s);
      },
      trial);
}

void Catalogue::kept_volumes() {
  Trial trial;
  trial.by_conserved_energy = true;
  trial.energy_room = 0.02;
  trial.steps = 2000;
  for (const int iterations : {1, 2, 50}) {
    const std::string each = std::to_string(iterations) + (iterations == 1 ? " iteration" : " iterations");
    add_kept(
        each + ", as stiff as is allowed", falling_body(), iterations,
        [](Setup& s) {
          s.body = sample(Lattice{.count = {5, 5, 5}, .spacing = 0.8f, .corner = {0, 0, 4}, .jitter = 0.05f});
          stir(s, 0.5f);
          s.material.update_threshold = 1e30f;
          s.material.elastic_time_step =
              std::max(0.01f, (1 - s.material.alpha.lowest()) * *s.config.time_step / 2.5f);
        },
        trial);
    add_kept(each + ", steps of four times time_step", falling_body(), iterations, [](Setup& s) {
      s.config.time_step_factor = 4;
      s.material.elastic_time_step = std::max(0.1f, (1 - s.material.alpha.lowest()) * 0.15f * 16 / 2.4f);
    });
    add_kept(each + ", with cohesion", falling_body(), iterations, [](Setup& s) { s.material.cohesion = 1; });
  }
  add_kept(
      "all damping as much as is allowed", falling_body(), 2,
      [](Setup& s) {
        damp_longest(s);
        s.material.deformation_damping = k_most_damping;
      },
      trial);
  trial.steps = 300;
  for (const float speed : {1.0f, 140.0f})
    add_kept(
        "two bodies head-on at " + std::to_string(static_cast<int>(speed)) + " a second", two_bodies(speed),
        2, [](Setup& s) { s.material.update_threshold = 1e30f; }, trial);
  for (const int thin : {1, 2})
    add_kept(std::to_string(thin) + (thin == 1 ? " layer" : " layers"), falling_body(), 2, [thin](Setup& s) {
      s.body = sample(Lattice{.count = {8, 8, thin}, .corner = {0, 0, 1}, .jitter = 0.05f});
    });
  trial = {};
  trial.energy_room = 1e9;  // pins do work
  trial.before_step = [](Simulation& simulation, int step) {
    if (step > 0) return;
    simulation.pin(Aabb{{-9, -9, -9}, {9, 9, 2}}, {0, 0, 0});
    simulation.pin(Aabb{{-9, -9, 5}, {9, 9, 9}}, {0, 0, -0.1f});
  };
  add_kept(
      "pressed between pins", falling_body(), 3, [](Setup&) {}, trial);
  Trial pressed;
  pressed.energy_room = 1e9;  // the plates do work without end
  pressed.steps = 700;
  add_kept(
      "between two plates that close", falling_body(), 3,
      [](Setup& s) {
        s.colliders.push_back(
            {.shape = Plane{.normal = {0, 0, -1}, .offset = -6.5f}, .velocity = {0, 0, -0.1f}});
      },
      pressed);
  trial = {};
  trial.energy_room = 1e3;
  trial.before_step = pour_a_layer_a_step;
  add_kept(
      "an emitter of a layer a step onto a body", falling_body(), 2, [](Setup&) {}, trial);
}

}  // namespace mallow::bench

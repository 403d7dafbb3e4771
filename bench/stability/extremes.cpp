// Extremes of settings, sizes, shapes and places.
#include "stability/catalogue.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "stability/knobs_together.h"

namespace mallow::bench {

std::vector<Extreme> Catalogue::list() && {
  neighbors();
  few_particles();
  shapes();
  magnitudes();
  places();
  contacts();
  elastic_limit();
  schedules();
  flow();
  bodies_that_touch();
  damping();
  bodies_that_come_and_go();
  colliders_that_move();
  kept_volumes();
  painted_bodies();
  heated_bodies();
  add_knobs_together(list_);
  return std::move(list_);
}

void Catalogue::add(const std::string& name, const Setup& base, const Change& change, const Trial& trial) {
  add_extremes(name, base, change, trial, list_);
}

void Catalogue::add_free(const std::string& name, const Change& change) {
  add(name, free_body(), [&](Setup& setup) {
    change(setup);
    if (setup.body.velocities.empty()) stir(setup, 0.2f);
  });
}

void Catalogue::neighbors() {
  add_free("nobody has a neighbour", [](Setup& s) { s.config.support_radius = 0.5f; });
  add_free("everybody is everybody's neighbour", [](Setup& s) { s.config.support_radius = 20; });
  add_free("a region of everybody", [](Setup& s) { s.material.region_radius = 20.0f; });
  add_free("a region of oneself", [](Setup& s) { s.material.region_radius = 0.5f; });
}

void Catalogue::few_particles() {
  for (const int n : {1, 2, 3})
    add_free(std::to_string(n) + (n == 1 ? " particle" : " particles"), [n](Setup& s) {
      s.body = sample(Lattice{.count = {n, 1, 1}, .jitter = 0});
    });
}

void Catalogue::shapes() {
  add_free("a line", [](Setup& s) { s.body = sample(Lattice{.count = {20, 1, 1}, .jitter = 0}); });
  add_free("a plane", [](Setup& s) { s.body = sample(Lattice{.count = {8, 8, 1}, .jitter = 0}); });
  add_free("crowded", [](Setup& s) {  // as near as they may be
    s.body.positions.clear();
    for (int i = 0; i < 20; ++i) s.body.positions.push_back(Vec3(1, 2, 3 + 0.101f * static_cast<float>(i)));
    s.body.velocity = {1, 0, 0};
  });
  for (Extreme* e = &list_.back() - 1; e <= &list_.back(); ++e)
    e->trial.energy_room = 1e3;  // pressure from the start
  add_free("crowded pairs", [](Setup& s) {
    const std::vector<Vec3> once = s.body.positions;
    for (const Vec3& x : once) s.body.positions.push_back(x + Vec3(0.101f, 0, 0));
  });
  list_.back().trial.energy_room = list_[list_.size() - 2].trial.energy_room =
      1e3;  // pressure from the start
  // In its first step every particle passes through the middle to the other side.
  add_free("turned inside out", [](Setup& s) {
    const Vec3 middle(2.5f, 2.5f, 3.5f);
    for (const Vec3& x : s.body.positions)
      s.body.velocities.push_back(2 / s.config.time_step.value() * (middle - x));
  });
  add_free("pressed flat", [](Setup& s) {
    for (const Vec3& x : s.body.positions)
      s.body.velocities.push_back(Vec3(0, 0, (3.5f - x.z()) / s.config.time_step.value()));
  });
}

void Catalogue::magnitudes() {
  add_free("velocities of 1e6", [](Setup& s) { stir(s, 1e6f); });
  add_free("all at 1e6", [](Setup& s) { s.body.velocity = {1e6f, 0, 0}; });
  for (const float mass : {1e-9f, 1e9f})
    add_free(mass < 1 ? "masses of 1e-9" : "masses of 1e9", [mass](Setup& s) {
      s.material.particle_mass = mass;
      s.material.viscosity.value() *= mass;  // the same material, in another unit of mass
    });
  add_free("light particles, viscosity as it was", [](Setup& s) { s.material.particle_mass = 1e-6f; });
  add("gravity of 1e4", falling_body(), [](Setup& s) { s.config.gravity = {0, 0, -1e4f}; });
  add_free("an elastic time step of a tenth", [](Setup& s) { s.material.elastic_time_step = 0.015f; });
  add_free("an elastic time step of a hundred", [](Setup& s) { s.material.elastic_time_step = 15.0f; });
  add_free("stride of 50", [](Setup& s) { s.material.region_stride = 50; });
  add_free("one rotation iteration", [](Setup& s) { s.config.rotation_iterations = 1; });
  add_free("printed formulas", [](Setup& s) { s.config.formulation = Formulation::printed; });
}

void Catalogue::places() {
  for (const float scale : {1e-3f, 1e3f})
    add(scale < 1 ? "a thousandth of the size" : "a thousand times the size", falling_body(),
        [scale](Setup& s) {
          *s.config.support_radius *= scale;
          s.config.gravity *= scale;
          s.body.spacing *= scale;
          for (Vec3& x : s.body.positions) x *= scale;
          // Accelerations scale like lengths, k like their squares.
          s.material.pressure_coefficient.value() *= scale * scale;
          s.material.update_threshold.value() *= scale;
          s.material.viscosity.value() /= scale;
        });
  add("at 1e5 from the origin", falling_body(), [](Setup& s) {
    for (Vec3& x : s.body.positions) x += Vec3(1e5f, -1e5f, 0);
  });
  add_free("in free flight at 1e5", [](Setup& s) {
    for (Vec3& x : s.body.positions) x += Vec3::Constant(1e5f);
  });
}

void Catalogue::contacts() {
  Trial pressed;
  pressed.energy_room = 1e9;  // the plates do work without end
  pressed.steps = 700;        // they meet after 430
  add(
      "between two plates that close", falling_body(),
      [](Setup& s) {
        s.colliders.push_back(
            {.shape = Plane{.normal = {0, 0, -1}, .offset = -6.5f}, .velocity = {0, 0, -0.1f}});
      },
      pressed);
  Trial inside;
  inside.energy_room = 1e9;  // it is pushed out, which lifts it
  add(
      "spawned inside a collider", falling_body(),
      [](Setup& s) {
        s.colliders.push_back({.shape = Box{.min = {-3, -3, -1}, .max = {8, 8, 9}}});
      },
      inside);
  add(
      "in the tip of two planes", falling_body(),
      [](Setup& s) {
        s.colliders = {{.shape = Plane{.normal = {1, 0, 0.2f}}},
                       {.shape = Plane{.normal = {-1, 0, 0.2f}, .offset = -5}},
                       {.shape = Plane{}}};
      },
      inside);
}

void Catalogue::elastic_limit() {
  Trial trial;
  trial.steps = std::min(long_steps_, 20'000);
  trial.energy_room = 0.02;
  trial.by_conserved_energy = true;
  for (const float radius : {1.1f, 1.6f, 2.1f, 2.9f})
    for (const float spacing : {1.0f, 0.8f}) {
      std::ostringstream name;
      name << "as stiff as is allowed, regions of " << radius / spacing << " spacings";
      add(
          name.str(), falling_body(),
          [=](Setup& s) {
            s.body =
                sample(Lattice{.count = {5, 5, 5}, .spacing = spacing, .corner = {0, 0, 4}, .jitter = 0.05f});
            stir(s, 0.5f);
            s.material.region_radius = radius;
            s.material.update_threshold = 1e30f;
            s.material.elastic_time_step =
                std::max(0.01f, (1 - s.material.alpha.lowest()) * *s.config.time_step / 2.5f);
            s.colliders[0].restitution = 1;
          },
          trial);
    }
}

void Catalogue::schedules() {
  Trial switched;
  switched.before_step = [](Simulation& simulation, int step) {
    simulation.set_alpha(MaterialId{0}, step % 2 == 0 ? 1.0f : 0.0f);
  };
  add(
      "alpha switched every step", falling_body(),
      [](Setup& s) {
        // What it keeps for both is there from the start.
        s.material.alpha = AlphaSchedule{{0, 0.0f}, {1, 1.0f}};
      },
      switched);
  add("updates in every step", falling_body(), [](Setup& s) {
    s.config.update_interval = 1;
    s.material.update_threshold = 0;
  });
  add("never an update", falling_body(), [](Setup& s) { s.material.update_threshold = 1e30f; });
  Trial rests;
  rests.steps = long_steps_;
  add(
      "rests for " + std::to_string(long_steps_) + " steps", falling_body(),
      [](Setup& s) {
        s.body = sample(Lattice{.count = {3, 3, 3}, .jitter = 0});
      },
      rests);
}

std::vector<Extreme> extremes(int long_steps) {
  return Catalogue(long_steps).list();
}

}  // namespace mallow::bench

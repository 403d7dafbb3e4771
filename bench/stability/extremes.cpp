#include "stability/extremes.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "stability/knobs_together.h"
#include "stability/setup.h"

namespace mallow::bench {
namespace {

class Catalogue {
 public:
  explicit Catalogue(int long_steps) : long_steps_(long_steps) {}

  std::vector<Extreme> list() && {
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

 private:
  void add(const std::string& name, const Setup& base, const Change& change, const Trial& trial = {}) {
    add_extremes(name, base, change, trial, list_);
  }
  void add_free(const std::string& name, const Change& change) {
    add(name, free_body(), [&](Setup& setup) {
      change(setup);
      if (setup.body.velocities.empty()) stir(setup, 0.2f);
    });
  }

  void neighbors() {
    add_free("nobody has a neighbour", [](Setup& s) { s.config.support_radius = 0.5f; });
    add_free("everybody is everybody's neighbour", [](Setup& s) { s.config.support_radius = 20; });
    add_free("a region of everybody", [](Setup& s) { s.material.region_radius = 20.0f; });
    add_free("a region of oneself", [](Setup& s) { s.material.region_radius = 0.5f; });
  }

  /// What its particles have of their own, side by side: of one half and of the other.
  void painted_bodies() {
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

  void heated_bodies() {
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

  void few_particles() {
    for (const int n : {1, 2, 3})
      add_free(std::to_string(n) + (n == 1 ? " particle" : " particles"), [n](Setup& s) {
        s.body = sample(Lattice{.count = {n, 1, 1}, .jitter = 0});
      });
  }

  void shapes() {
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

  void magnitudes() {
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

  void places() {
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

  void contacts() {
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

  /// As stiff as a step can carry, on a floor that gives all back: model 2, section 4 B.
  void elastic_limit() {
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
              s.body = sample(
                  Lattice{.count = {5, 5, 5}, .spacing = spacing, .corner = {0, 0, 4}, .jitter = 0.05f});
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

  void schedules() {
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

  /// Matter that flows takes energy and gives none: model 2, section 5.
  void flow() {
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

  /// Contact takes energy and adds none: model 2, section 4 C.
  void bodies_that_touch() {
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

  /// Damping at its limit takes energy and adds none.
  void damping() {
    Trial trial;
    trial.by_conserved_energy = true;
    trial.energy_room = 0.02;
    trial.steps = 2000;
    for (const bool both : {false, true})
      add(
          both ? "all damping as much as is allowed" : "a damping time as long as is allowed", falling_body(),
          [&](Setup& s) {
            // a (1 + 2 τ/Δt) = 2.5 with a = (1 − alpha)
            const float a = std::max(0.01f, 1 - s.material.alpha.lowest());
            s.material.damping_time = 0.999f * 0.15f * (2.5f / a - 1) / 2;
            if (both) s.material.deformation_damping = 6.3f;  // the most is 6.31 at alpha 0
            s.material.update_threshold = 1e30f;
            stir(s, 0.5f);
          },
          trial);
  }

  /// Energy comes with matter: what is asked is that all stays finite and slow.
  void bodies_that_come_and_go() {
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

  /// What pushes does work; particles stay finite, and outside of it.
  void colliders_that_move() {
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
            s.colliders.push_back({.shape = Box{.min = {-4, -0.5f, 0}, .max = {4, 0.5f, 8}},
                                   .angular_velocity = {0, 0, turns}});
          },
          trial);
  }

  void add_kept(const std::string& name, const Setup& base, int iterations, const Change& change,
                const Trial& trial = {}) {
    add(
        "volume kept, " + name, base,
        [&](Setup& s) {
          s.config.volume_iterations = iterations;
          s.material.pressure_coefficient = {};
          change(s);
        },
        trial);
  }

  /// Corrections take energy but for what was pressed together at the start: model 2, section 2.
  void kept_volumes() {
    Trial trial;
    trial.by_conserved_energy = true;
    trial.energy_room = 0.02;
    trial.steps = 2000;
    for (const int iterations : {1, 2, 50}) {
      const std::string each = std::to_string(iterations) + (iterations == 1 ? " iteration" : " iterations");
      add_kept(
          each + ", as stiff as is allowed", falling_body(), iterations,
          [](Setup& s) {
            s.body =
                sample(Lattice{.count = {5, 5, 5}, .spacing = 0.8f, .corner = {0, 0, 4}, .jitter = 0.05f});
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
      add_kept(each + ", with cohesion", falling_body(), iterations,
               [](Setup& s) { s.material.cohesion = 1; });
    }
    add_kept(
        "all damping as much as is allowed", falling_body(), 2,
        [](Setup& s) {
          const float a = std::max(0.01f, 1 - s.material.alpha.lowest());
          s.material.damping_time = 0.999f * 0.15f * (2.5f / a - 1) / 2;
          s.material.deformation_damping = 6.3f;
          s.material.update_threshold = 1e30f;
          stir(s, 0.5f);
        },
        trial);
    trial.steps = 300;
    for (const float speed : {1.0f, 140.0f})
      add_kept(
          "two bodies head-on at " + std::to_string(static_cast<int>(speed)) + " a second", two_bodies(speed),
          2, [](Setup& s) { s.material.update_threshold = 1e30f; }, trial);
    for (const int thin : {1, 2})
      add_kept(std::to_string(thin) + (thin == 1 ? " layer" : " layers"), falling_body(), 2,
               [thin](Setup& s) {
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

  int long_steps_;
  std::vector<Extreme> list_;
};

}  // namespace

std::vector<Extreme> extremes(int long_steps) {
  return Catalogue(long_steps).list();
}

}  // namespace mallow::bench

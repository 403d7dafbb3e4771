#include "stability/knobs_together.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mallow/defaults.h"
#include "stability/setup.h"

namespace mallow::bench {
namespace {

// Knobs, each of which a row turns or leaves. Those that come later see what those before made of the setup.

void yields(Setup& s) {
  s.material.plastic_yield = 0.05f;
  s.material.update_threshold.reset();
  s.config.update_interval = 10;
}

void keeps_volume(Setup& s) {
  s.config.volume_iterations = 2;
  s.material.pressure_coefficient.reset();
}

/// Layers of alpha 0, of the material's and of 1 that take turns, and of two moduli.
void is_painted(Setup& s) {
  const float own = s.material.alpha.lowest();
  for (const Vec3& x : s.body.positions) {
    const int layer = static_cast<int>(std::floor(x.x())) % 3;
    s.body.alpha.push_back(layer == 0 ? 0.0f : layer == 1 ? own : 1.0f);
    s.body.stiffness.push_back(x.y() < 2.5f ? 1.0f : 0.01f);
  }
}

/// The largest share (1 − alpha) that anything in it has.
float most_share(const Setup& s) {
  float lowest = s.material.alpha.lowest();
  for (const float alpha : s.body.alpha) lowest = std::min(lowest, alpha);
  if (s.material.alpha_by_temperature) lowest = std::min(lowest, s.material.alpha_by_temperature->lowest());
  return std::max(0.01f, 1 - lowest);
}

/// 1 of 1.6 of what a step carries is left for the modulus.
void is_damped(Setup& s) {
  s.material.damping_time = 0.3f * s.config.time_step.value();
  s.material.deformation_damping = 3.0f;
}

/// The largest modulus that a step carries, which an error names where it is too large.
void is_stiffest(Setup& s) {
  s.material.alpha = 1 - most_share(s);
  s.material.youngs_modulus = 1.0f;
  Simulation probe = s.build();
  s.material.youngs_modulus = 0.999f * probe.info().bodies.front().most_youngs_modulus;
}

/// One half of it is frozen, the other hot; flows in between.
void is_heated(Setup& s) {
  s.material.temperature = 0.0f;
  s.material.conductivity = 1;
  s.material.specific_heat = 1;
  s.material.latent_heat = 50;
  s.material.solidus = 1.0f;
  s.material.liquidus = 100.0f;
  s.material.alpha_by_temperature = Schedule{{1, std::min(0.9f, s.material.alpha.lowest())}, {100, 1}};
  for (const Vec3& x : s.body.positions) s.body.temperature.push_back(x.x() < 2.5f ? 0.0f : 1000.0f);
}

struct Knob {
  const char* name;
  void (*turn)(Setup&);
};
constexpr Knob k_yield{"yields", yields}, k_volume{"keeps its volume", keeps_volume},
    k_paint{"is painted", is_painted}, k_damping{"is damped", is_damped}, k_heat{"is heated", is_heated},
    k_stiffest{"is as stiff as is allowed", is_stiffest};

/// In the order in which they are to be turned.
const std::vector<std::vector<Knob>> k_together = {
    {k_yield, k_volume},
    {k_yield, k_paint},
    {k_yield, k_stiffest},
    {k_yield, k_damping},
    {k_yield, k_heat},
    {k_volume, k_paint},
    {k_volume, k_heat},
    {k_paint, k_damping, k_stiffest},
    {k_volume, k_damping, k_stiffest},
    {k_yield, k_volume, k_stiffest},
    {k_yield, k_volume, k_damping, k_stiffest},
    {k_yield, k_volume, k_paint, k_damping, k_stiffest},
    {k_yield, k_volume, k_heat, k_damping, k_stiffest},
};

class Together {
 public:
  explicit Together(std::vector<Extreme>& list) : list_(list) {}

  void all() {
    for (const std::vector<Knob>& knobs : k_together) {
      // What is heated melts: what its springs hold is lost, and no energy of theirs is to be compared.
      add(
          "thrown", knobs, 0.03,
          [](Setup& s) {
            s.body = sample(Lattice{.count = {6, 5, 5}, .corner = {0, 0, 1}, .jitter = 0.1f});
            s.config.gravity = Vec3::Zero();
            s.colliders.clear();
          },
          [](Setup& s) { stir(s, 2.0f); });
      // A floor that gives all back and damping as much as is allowed: 6.6% at the most, none at a
      // restitution of 0.
      add("dropped", knobs, 0.08, [](Setup& s) {
        s.body = sample(Lattice{.count = {5, 5, 5}, .corner = {0, 0, 4}, .jitter = 0.05f});
        s.colliders[0].restitution = 1;
      });
    }
    const std::vector<Knob> most = {k_yield, k_volume, k_paint, k_damping, k_stiffest};
    for (const std::array<int, 3> count : {std::array{8, 8, 1}, std::array{8, 8, 2}, std::array{20, 1, 1}}) {
      const std::string shape = count[1] == 1 ? "a line" : count[2] == 1 ? "a sheet" : "two layers";
      const Change thin = [count](Setup& s) {
        s.body = sample(Lattice{.count = count, .corner = {0, 0, 4}, .jitter = 0.1f});
      };
      add(shape, most, 0.03, thin);
      add(shape, {k_yield, k_volume, k_heat}, 0.03, thin);
    }
    calls();
  }

 private:
  void add(
      const std::string& what, const std::vector<Knob>& knobs, double room, const Change& before,
      const Change& after = [](Setup&) {}, Trial trial = {.steps = 1000}) {
    std::string name = what;
    for (const Knob& knob : knobs) name += std::string(&knob == knobs.data() ? ": " : ", ") + knob.name;
    trial.energy_room = room;
    trial.by_conserved_energy = room < 1;
    trial.compares_bits = true;
    add_extremes(
        name, falling_body(),
        [&](Setup& s) {
          s.material.update_threshold = 1e30f;
          before(s);
          for (const Knob& knob : knobs) knob.turn(s);
          after(s);
        },
        trial, list_);
  }

  /// What changes from step to step.
  void calls() {
    Trial trial{.steps = 600};
    trial.before_step = pour_a_layer_a_step;
    add(
        "poured onto", {k_yield, k_volume}, 1e3, [](Setup&) {}, [](Setup&) {}, trial);
    add(
        "poured onto", {k_yield, k_volume, k_damping, k_stiffest}, 1e3, [](Setup&) {}, [](Setup&) {}, trial);
    add(
        "poured onto", {k_yield, k_volume, k_heat}, 1e3, [](Setup&) {}, [](Setup&) {}, trial);
    trial.before_step = [](Simulation& simulation, int step) {
      if (step % 20 != 0) return;
      std::vector<ParticleId> some;
      for (std::size_t row = 0; row < simulation.particle_count(); row += 3)
        some.push_back(simulation.ids()[row]);
      simulation.set_temperature(some, step % 40 == 0 ? 1e5f : -1e5f);
    };
    // Each jump does work: what has melted and moved is a solid again, of the shape that it had, as no update
    // lets it rest anew here. It is to stay finite, and the same for any thread count.
    add(
        "temperatures that jump", {k_yield, k_volume, k_heat}, 1e6, [](Setup&) {}, [](Setup&) {}, trial);
    trial.before_step = [](Simulation& simulation, int step) {
      Material material = simulation.material_settings(MaterialId{0});
      if (step % 2 == 0) {
        material.plastic_yield.reset();
      } else {
        material.plastic_yield = step % 4 == 1 ? 0.0f : 0.3f;
      }
      simulation.set_material(MaterialId{0}, material);
    };
    add(
        "yield that is set in every step", {k_yield, k_volume}, 1e3, [](Setup&) {}, [](Setup&) {}, trial);
  }

  std::vector<Extreme>& list_;
};

}  // namespace

void add_knobs_together(std::vector<Extreme>& list) {
  Together(list).all();
}

}  // namespace mallow::bench

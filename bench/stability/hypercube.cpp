#include "stability/hypercube.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <sstream>

#include "stability/setup.h"

namespace mallow::bench {
namespace {

constexpr int k_steps = 400;
/// A share of a knob's way at which it is left out.
constexpr float k_off = 0.25f;

std::string number(float value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}
float by_factors(float low, float high, float turn) {
  return low * std::pow(high / low, turn);
}
float evenly(float low, float high, float turn) {
  return low + (high - low) * turn;
}

/// What a turn of a knob makes of a setup; returns what it set. Those that come later see what those before
/// did.
struct Knob {
  const char* name;
  std::string (*turn)(Setup&, float);
};

/// A knob that is left out in the first quarter of its way.
template <class Set>
std::string or_out(float turn, const Set& set) {
  return turn < k_off ? "left out" : set((turn - k_off) / (1 - k_off));
}

/// Cut at the ends, which so are met more often than by chance.
std::string turn_alpha(Setup& s, float turn) {
  const float alpha = std::clamp(evenly(-0.15f, 1.15f, turn), 0.0f, 1.0f);
  s.material.alpha = alpha;
  return number(alpha);
}
std::string turn_step(Setup& s, float turn) {
  s.config.time_step_factor = by_factors(0.25f, 2.5f, turn);
  return number(s.config.time_step_factor);
}
std::string turn_radius(Setup& s, float turn) {
  s.config.support_radius = evenly(1.6f, 3.2f, turn);
  return number(*s.config.support_radius);
}
std::string turn_yield(Setup& s, float turn) {
  return or_out(turn, [&](float t) {
    s.material.plastic_yield = by_factors(0.002f, 0.5f, t);
    return number(*s.material.plastic_yield);
  });
}
std::string turn_creep(Setup& s, float turn) {
  if (!s.material.plastic_yield) return "left out";
  return or_out(turn, [&](float t) {
    s.material.plastic_creep = by_factors(0.01f, 1000, t);
    return number(*s.material.plastic_creep);
  });
}
std::string turn_updates(Setup& s, float turn) {
  s.material.update_threshold = 1e30f;
  if (s.material.plastic_yield) s.material.update_threshold.reset();
  return or_out(turn, [&](float t) {
    s.material.update_threshold = by_factors(0.1f, 30, t);
    return number(*s.material.update_threshold);
  });
}
std::string turn_checks(Setup& s, float turn) {
  s.config.update_interval = static_cast<int>(by_factors(1, 100, turn));
  return std::to_string(*s.config.update_interval);
}
float longest_step(const Setup& s) {
  return *s.config.time_step * s.config.time_step_factor;
}
/// In steps: it is a part of what they carry.
std::string turn_damping_time(Setup& s, float turn) {
  return or_out(turn, [&](float t) {
    const float steps = by_factors(0.01f, 3, t);
    s.material.damping_time = steps * longest_step(s);
    return number(steps);
  });
}
std::string turn_damping(Setup& s, float turn) {
  return or_out(turn, [&](float t) {
    s.material.deformation_damping = t < 0.1f ? 0.0f : by_factors(0.01f, 10, t);
    return number(*s.material.deformation_damping);
  });
}
std::string turn_iterations(Setup& s, float turn) {
  s.config.volume_iterations = std::min(5, static_cast<int>(6 * turn));
  return std::to_string(*s.config.volume_iterations);
}
std::string turn_pressure(Setup& s, float turn) {
  s.material.pressure_coefficient.reset();
  return or_out(turn, [&](float t) {
    s.material.pressure_coefficient = t < 0.2f ? 0.0f : by_factors(1, 2000, t);
    return number(*s.material.pressure_coefficient);
  });
}
std::string turn_viscosity(Setup& s, float turn) {
  s.material.viscosity.reset();
  return or_out(turn, [&](float t) {
    s.material.viscosity = by_factors(0.01f, 100, t);
    return number(*s.material.viscosity);
  });
}
/// One half is hot: it melts, thins and softens the other, and no half sets again.
std::string turn_heat(Setup& s, float turn) {
  if (turn < 0.5f) return "left out";
  const float conductivity = by_factors(0.01f, 100, 2 * turn - 1);
  const float alpha = s.material.alpha.lowest();
  s.material.temperature = 0.0f;
  s.material.conductivity = conductivity;
  s.material.specific_heat = 1;
  s.material.latent_heat = 50;
  s.material.solidus = 1.0f;
  s.material.liquidus = 100.0f;
  s.material.alpha_by_temperature = Schedule{{1, alpha}, {100, 1}};
  if (s.material.plastic_yield)
    s.material.plastic_yield_by_temperature =
        Schedule{{1, *s.material.plastic_yield}, {100, *s.material.plastic_yield / 10}};
  if (s.material.viscosity)
    s.material.viscosity_by_temperature =
        Schedule{{1, *s.material.viscosity}, {100, *s.material.viscosity / 10}};
  for (const Vec3& x : s.body.positions) s.body.temperature.push_back(x.x() < 2.5f ? 0.0f : 1000.0f);
  return number(conductivity);
}

/// As a share of what a step carries at its alpha beside its damping time. Beyond that, the last eighth of
/// the way, it is to be refused. A fluid has none.
std::string turn_modulus(Setup& s, float turn) {
  if (s.material.alpha.lowest() == 1) return "left out";
  const float share = by_factors(0.01f, 2, turn);
  Setup probe = s;
  probe.material.damping_time = 0;
  probe.material.youngs_modulus = 1e-6f;
  const float most = probe.build().info().bodies.front().most_youngs_modulus;
  s.material.youngs_modulus = share * most / (1 + 2 * s.material.damping_time / longest_step(s));
  return number(share);
}

std::string turn_motion(Setup& s, float turn) {
  const float speed = by_factors(0.5f, 5, std::fmod(2 * turn, 1.0f));
  stir(s, speed);
  if (turn < 0.5f) {
    s.config.gravity = Vec3::Zero();
    s.colliders.clear();
    return "thrown, " + number(speed);
  }
  return "dropped, " + number(speed);
}
std::string turn_bounce(Setup& s, float turn) {
  const float restitution = std::max(0.0f, evenly(-0.5f, 1, turn));
  for (Collider& collider : s.colliders) collider.restitution = restitution;
  return number(restitution);
}

/// In the order in which they are turned.
constexpr Knob k_knobs[] = {
    {"motion: thrown at 0.5 to 5 h/s, dropped at 0.5 to 5 h/s", turn_motion},
    {"restitution of the floor: 0 in a third, to 1", turn_bounce},
    {"alpha: 0 to 1", turn_alpha},
    {"time_step_factor: 0.25 to 2.5", turn_step},
    {"support_radius: 1.6 to 3.2 h", turn_radius},
    {"plastic_yield: none, 0.002 to 0.5", turn_yield},
    {"plastic_creep: none, 0.01 to 1000/s", turn_creep},
    {"update_threshold: none, 0.1 to 30", turn_updates},
    {"update_interval: 1 to 100", turn_checks},
    {"damping_time: none, 0.01 to 3 steps", turn_damping_time},
    {"deformation_damping: left out, 0 to 10/s", turn_damping},
    {"volume_iterations: 0 to 5", turn_iterations},
    {"pressure_coefficient: left out, 0 to 2000", turn_pressure},
    {"viscosity: left out, 0.01 to 100", turn_viscosity},
    {"conductivity: no heat in a half, 0.01 to 100", turn_heat},
    {"youngs_modulus: 0.01 to 2 of what a step carries", turn_modulus},
};

/// Whole numbers below n, in an order that <random>'s generator alone settles.
std::vector<std::size_t> shuffled(std::size_t n, std::mt19937& generator) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t k = n; k > 1; --k) std::swap(order[k - 1], order[generator() % k]);
  return order;
}

Mixture mixture(const std::vector<float>& turns) {
  Mixture mixture;
  Setup setup = falling_body();
  setup.material = {};
  // Nothing is pressed together at the start: what pressure holds is no part of the energy that is looked at.
  // Cohesion, which draws from the first step on, is left out for the same reason.
  setup.body = sample(Lattice{.count = {6, 5, 5}, .corner = {0, 0, 2}, .jitter = 0});
  for (std::size_t k = 0; k < turns.size(); ++k)
    mixture.knobs.push_back({k_knobs[k].name, turns[k], k_knobs[k].turn(setup, turns[k])});
  // A floor that gives nearly all back, and damping, let 7% come out of what layers do that hit it at once
  // (knobs_together.cpp).
  mixture.trial = trial_of(
      setup, {.steps = k_steps, .energy_room = turns[0] < 0.5f ? 0.03 : 0.08, .by_conserved_energy = true});
  return mixture;
}

}  // namespace

std::vector<Mixture> hypercube(std::size_t count, std::uint32_t seed) {
  constexpr std::size_t k_count = std::size(k_knobs);
  std::mt19937 generator(seed);
  std::vector<std::vector<std::size_t>> parts;
  for (std::size_t k = 0; k < k_count; ++k) parts.push_back(shuffled(count, generator));
  std::vector<Mixture> mixtures;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<float> turns;
    for (std::size_t k = 0; k < k_count; ++k) {
      const double within = static_cast<double>(generator() >> 8) / (1 << 24);
      turns.push_back(
          static_cast<float>((static_cast<double>(parts[k][i]) + within) / static_cast<double>(count)));
    }
    mixtures.push_back(mixture(turns));
  }
  return mixtures;
}

}  // namespace mallow::bench

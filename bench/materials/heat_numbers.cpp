#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "mallow/simulation.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

constexpr double k_pi = std::numbers::pi, k_diffusivity = 0.4;

/// What conducts heat and does not move: jitter would push bodies off what they touch.
Simulation held(const std::array<int, 3>& count, const Material& material, int threads) {
  Simulation s({.time_step = 0.15f,
                .support_radius = 2.1f,
                .gravity = {0, 0, 0},
                .air_temperature = 0.0f,
                .threads = threads});
  s.add_body(sample(Lattice{.count = count}), material);
  s.pin({{-99, -99, -99}, {99, 99, 99}});
  return s;
}
Collider plate(const Plane& plane, float temperature) {
  return {.shape = plane, .temperature = temperature};
}

/// Largest distance of a temperature from theory(x).
template <class Theory>
double farthest(const Simulation& s, const Theory& theory) {
  double most = 0;
  for (std::size_t row = 0; row < s.particle_count(); ++row)
    most = std::max(most, std::abs(static_cast<double>(s.temperatures()[row]) -
                                   theory(static_cast<double>(s.positions()[row].x()))));
  return most;
}

/// T of a slab of length 1 that was at 0 and is held at 0 and 1, at x after the Fourier number f.
double in_slab(double x, double f) {
  double sum = x;
  for (int n = 1; n < 200; ++n)
    sum +=
        2 / (n * k_pi) * (n % 2 == 0 ? 1 : -1) * std::sin(n * k_pi * x) * std::exp(-n * n * k_pi * k_pi * f);
  return sum;
}

void slab(int threads, const AddNumber& add) {
  Simulation s =
      held({20, 6, 6}, {.temperature = 0.0f, .conductivity = 1.0f, .specific_heat = 2.5f}, threads);
  s.add_collider(plate({{1, 0, 0}, 0}, 0));
  s.add_collider(plate({{-1, 0, 0}, -20}, 100));
  for (const double f : {0.05, 0.2, 0.5}) {
    s.advance(f * 400 / k_diffusivity - s.time());
    add("slab at 0 and 100 K", "Fourier number " + std::to_string(f).substr(0, 4),
        {"largest error [K]", farthest(s, [&](double x) { return 100 * in_slab(x / 20, f); })});
  }
}

void half_space(int threads, const AddNumber& add) {
  Simulation s =
      held({60, 4, 4}, {.temperature = 100.0f, .conductivity = 1.0f, .specific_heat = 2.5f}, threads);
  s.add_collider(plate({{1, 0, 0}, 0}, 0));
  s.advance(100);
  add("half space of 100 K at 0 K", "after 100 s",
      {"largest error [K]", farthest(s, [](double x) { return 100 * std::erf(x / (2 * std::sqrt(40.0))); })});
}

/// The front is at 2 λ √(D t), with λ exp(λ²) erf(λ) √π = c T/L.
void melt(int threads, const AddNumber& add) {
  constexpr double k_lambda = 0.6201;  // at c T/L = 1
  Simulation s = held({40, 4, 4},
                      {.temperature = 0.0f,
                       .conductivity = 1.0f,
                       .specific_heat = 2.5f,
                       .latent_heat = 250,
                       .solidus = 0.0f,
                       .liquidus = 2.0f},
                      threads);
  s.add_collider(plate({{1, 0, 0}, 0}, 100));
  for (const double t : {100.0, 400.0}) {
    s.advance(t - s.time());
    double melted = 0;
    for (const float temperature : s.temperatures())
      melted += std::clamp(static_cast<double>(temperature) / 2, 0.0, 1.0);
    add("melting front (Stefan)", "after " + std::to_string(static_cast<int>(t)) + " s",
        {"at [h]", melted / 16, 2 * k_lambda * std::sqrt(k_diffusivity * t)});
  }
}

void cool(int threads, const AddNumber& add) {
  Simulation s =
      held({12, 12, 12},
           {.temperature = 100.0f, .conductivity = 100.0f, .specific_heat = 100.0f, .heat_transfer = 1.0f},
           threads);
  s.advance(60);
  double mean = 0;
  for (const float t : s.temperatures()) mean += static_cast<double>(t) / 1728;
  add("cube of 100 K in air of 0 K", "after 60 s",
      {"mean [K]", mean, 100 * std::exp(-6.0 * 144 * 60 / (1728 * 100.0))});
}

}  // namespace

void measure_heat(int threads, const AddNumber& add) {
  slab(threads, add);
  half_space(threads, add);
  melt(threads, add);
  cool(threads, add);
}

}  // namespace mallow::bench

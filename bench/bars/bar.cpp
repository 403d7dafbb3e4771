#include "bars/bar.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

#include "mallow/mallow.h"

namespace mallow::bars {
namespace {

constexpr double k_pi = std::numbers::pi;
/// Of the length, by which loads bend or stretch.
constexpr double k_deflection = 0.01;
/// Layers that are held: two regions deep.
constexpr int k_held = 6;
/// Torsion constant of a square by side⁴, and its polar moment of area.
constexpr double k_torsion = 0.1406, k_polar = 1.0 / 6;

/// A bar along x from 0 on, and the rows of its last layer.
struct Held {
  Simulation simulation;
  std::vector<std::size_t> end;
  std::vector<Vec3> start;
};

Held hold(const Bar& bar, const Vec3& gravity, const std::function<Vec3(const Vec3&)>& velocity = {}) {
  const float h = static_cast<float>(bar.spacing);
  const float half = static_cast<float>(0.5 * bar.side());
  const float radius = static_cast<float>(bar.radius * bar.spacing);
  Simulation s({.time_step = static_cast<float>(bar.time_step),
                .support_radius = radius,
                .gravity = gravity,
                .sleep_speed = 0.0f,
                .threads = bar.threads});
  Body body = sample(Lattice{.count = {bar.along + k_held, bar.across, bar.across},
                             .spacing = h,
                             .corner = {-h * static_cast<float>(k_held), -half, -half}});
  if (velocity)
    for (const Vec3& x : body.positions) body.velocities.push_back(velocity(x));
  const BodyId id = s.add_body(body, {.alpha = static_cast<float>(bar.alpha),
                                      .update_threshold = 1e9f,
                                      .youngs_modulus = static_cast<float>(bar.modulus),
                                      .rest_density = static_cast<float>(bar.density),
                                      .deformation_damping = 0.0f,
                                      .region_stride = bar.region_stride});
  s.pin(Aabb{{-10 * half - 100 * h, -10 * half, -10 * half}, {0, 10 * half, 10 * half}});
  s.prepare();
  Held held{std::move(s), {}, {}};
  const auto rows = held.simulation.rows(id);
  const VectorView positions = held.simulation.positions();
  const float last = static_cast<float>(bar.length() - bar.spacing);
  for (std::size_t row = rows.begin; row < rows.end; ++row)
    if (positions[row].x() > last) {
      held.end.push_back(row);
      held.start.push_back(positions[row]);
    }
  return held;
}

/// Steps until what is measured of the end has passed `level` upwards twice, a period apart.
Swing swing(Held held, double level, double longest,
            const std::function<double(std::span<const Vec3>, std::span<const Vec3>)>& measure) {
  double before = 0, from = -1, sum = 0, time_before = 0;
  std::vector<Vec3> now(held.end.size());
  while (held.simulation.time() < longest) {
    held.simulation.step();
    const VectorView positions = held.simulation.positions();
    for (std::size_t k = 0; k < now.size(); ++k) now[k] = positions[held.end[k]];
    const double value = measure(held.start, now), time = held.simulation.time();
    if (before < level && value >= level) {
      const double share = (level - before) / (value - before);
      const double crossing = time_before + share * (time - time_before);
      if (from >= 0) return {sum / (crossing - from), crossing - from};
      from = crossing;
    }
    if (from >= 0) sum += value * (time - time_before);
    before = value;
    time_before = time;
  }
  throw std::runtime_error("a bar does not swing");
}

double mean_way(std::span<const Vec3> start, std::span<const Vec3> now, int axis, double sign) {
  double sum = 0;
  for (std::size_t k = 0; k < now.size(); ++k)
    sum += sign * (static_cast<double>(now[k][axis]) - static_cast<double>(start[k][axis]));
  return sum / static_cast<double>(now.size());
}

/// Mean angle about x [rad].
double mean_turn(std::span<const Vec3> start, std::span<const Vec3> now) {
  double sine = 0, cosine = 0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double y = static_cast<double>(start[k].y()), z = static_cast<double>(start[k].z());
    const double v = static_cast<double>(now[k].y()), w = static_cast<double>(now[k].z());
    sine += y * w - z * v;
    cosine += y * v + z * w;
  }
  return std::atan2(sine, cosine);
}

/// By which gravity stretches [m] the bar: ρ g L²/(2 E).
double gravity_of_stretch(const Bar& bar) {
  return k_deflection * 2 * bar.stiffness() / (bar.density * bar.length());
}
/// ρ g L⁴ 12/(8 E side²).
double gravity_of_bend(const Bar& bar) {
  return k_deflection * bar.stiffness() * bar.side() * bar.side() /
         (1.5 * bar.density * std::pow(bar.length(), 3));
}

}  // namespace

Swing theory_of_bend(const Bar& bar) {
  const double omega = 3.516 * bar.side() / (std::sqrt(12.0) * bar.length() * bar.length()) *
                       std::sqrt(bar.stiffness() / bar.density);
  return {k_deflection * bar.length(), 2 * k_pi / omega};
}

Swing theory_of_stretch(const Bar& bar) {
  return {k_deflection * bar.length(), 4 * bar.length() / std::sqrt(bar.stiffness() / bar.density)};
}

Swing theory_of_twist(const Bar& bar) {
  const double shear = 0.5 * bar.stiffness();
  return {0, 4 * bar.length() / std::sqrt(shear * k_torsion / (bar.density * k_polar))};
}

double timoshenko_share(const Bar& bar) {
  return 0.8 * bar.side() * bar.side() / (bar.length() * bar.length());
}

Swing bend(const Bar& bar) {
  const Swing theory = theory_of_bend(bar);
  return swing(hold(bar, {0, 0, -static_cast<float>(gravity_of_bend(bar))}), theory.rest, 5 * theory.period,
               [](auto start, auto now) { return mean_way(start, now, 2, -1); });
}

Swing stretch(const Bar& bar) {
  const Swing theory = theory_of_stretch(bar);
  return swing(hold(bar, {static_cast<float>(gravity_of_stretch(bar)), 0, 0}), theory.rest, 5 * theory.period,
               [](auto start, auto now) { return mean_way(start, now, 0, 1); });
}

Swing twist(const Bar& bar) {
  const Swing theory = theory_of_twist(bar);
  constexpr double k_turn = 0.05;  // [rad], to either side
  const double rate = k_turn * 2 * k_pi / theory.period;
  const auto velocity = [&](const Vec3& x) {
    const double share = std::sin(0.5 * k_pi * std::max(0.0, static_cast<double>(x.x())) / bar.length());
    return Vec3(static_cast<float>(rate * share) * Vec3(0, -x.z(), x.y()));
  };
  return swing(hold(bar, {0, 0, 0}, velocity), 0, 5 * theory.period,
               [](auto start, auto now) { return mean_turn(start, now); });
}

}  // namespace mallow::bars

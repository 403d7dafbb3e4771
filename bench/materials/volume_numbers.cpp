#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "mallow/simulation.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

constexpr float k_alphas[] = {0, 0.3f, 0.7f, 0.9f, 1};
constexpr float k_squeezed_only = 0.9f;

/// -1: to the tolerance.
struct Iterations {
  int count;
  std::string text() const {
    if (count < 0) return "to a tolerance of 0.001";
    return std::to_string(count) + (count == 1 ? " iteration" : " iterations");
  }
};
constexpr Iterations k_iterations[] = {{0}, {1}, {2}, {3}, {-1}};

SolverConfig solver(const Iterations& iterations, int threads) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, -0.3f},
          .volume_iterations = iterations.count < 0 ? 50 : iterations.count,
          .volume_tolerance = iterations.count < 0 ? 1e-3f : 0.0f,
          .sleep_speed = 0.0f,
          .threads = threads};
}

std::string setting(float alpha, const Iterations& iterations) {
  std::ostringstream text;
  text << "alpha " << alpha << ", " << iterations.text();
  return text.str();
}

/// Largest ρ/ρ0.
double worst(const Simulation& s, float rest_density) {
  return s.densities().empty() ? 0 : static_cast<double>(std::ranges::max(s.densities()) / rest_density);
}

/// The cube of 15³ of the paper's Table 1, with pressure only where no iteration keeps volume.
void drop(float alpha, const Iterations& iterations, int threads, const AddNumber& add) {
  constexpr int k_steps = 400, k_rests = 50;
  if (alpha == 0 && iterations.count == 0) return;  // nothing finds densities then
  SolverConfig config = solver(iterations, threads);
  config.support_radius = 2.9f;
  config.update_interval = 20;
  config.wall_pressure = false;
  config.acoustic_limit = iterations.count != 0;
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.add_body(sample(Lattice{.count = {15, 15, 15}, .spacing = 22.0f / 15, .corner = {0, 0, 10}, .jitter = 0}),
             {.alpha = alpha,
              .update_threshold = 1.0f,
              .pressure_coefficient = iterations.count == 0 ? 16.0f : 0.0f,
              .viscosity = 0.5f});
  s.prepare();
  const float rest_density = s.info().bodies[0].rest_density;
  double impact = 0, rest = 0, taken = 0;
  for (int k = 0; k < k_steps; ++k) {
    taken += 1.0 * s.step().volume_iterations / k_steps;
    impact = std::max(impact, worst(s, rest_density));
    if (k >= k_steps - k_rests) rest = std::max(rest, worst(s, rest_density));
  }
  const std::string name = setting(alpha, iterations);
  add("dropped", name, {"worst density", impact});
  add("dropped", name, {"worst density at rest", rest});
  if (iterations.count < 0) add("dropped", name, {"iterations a step", taken});
}

/// A cube of 10³ between plates that take a fifth of its height in 100 steps and give it back.
void squeeze(float alpha, const Iterations& iterations, int threads, const AddNumber& add) {
  constexpr int k_way = 100;
  if (alpha == 0 && iterations.count == 0) return;
  SolverConfig config = solver(iterations, threads);
  config.gravity = {0, 0, 0};
  config.wall_pressure = false;
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  const ColliderId top = s.add_collider({.shape = Plane{{0, 0, -1}, -10}, .friction = 0.3f});
  const BodyId id = s.add_body(sample(Lattice{.count = {10, 10, 10}, .jitter = 0}),
                               {.alpha = alpha, .update_threshold = 1e6f});
  s.prepare();
  const std::vector<Vec3> start = s.positions_by_id();
  const float rest_density = s.info().bodies[0].rest_density;
  double most = 0, wide = 0, left = 0;
  for (int k = 0; k < 3 * k_way; ++k) {
    const float speed = k < k_way ? -2.0f : k < 2 * k_way ? 2.0f : 0.0f;
    s.set_twist(top, {0, 0, speed / (k_way * 0.15f)}, {0, 0, 0});
    s.step();
    most = std::max(most, worst(s, rest_density));
    const auto [low, high] = std::ranges::minmax_element(s.positions().x());
    if (k == k_way - 1) wide = static_cast<double>(*high - *low + 1) / 10;
  }
  const Vec3 shift = (s.motion(id).center_of_mass - Eigen::Vector3d(5, 5, 5)).cast<float>();
  const std::vector<Vec3> end = s.positions_by_id();
  for (std::size_t i = 0; i < end.size(); ++i)
    left += static_cast<double>((end[i] - start[i] - shift).norm()) / static_cast<double>(end.size());
  const std::string name = setting(alpha, iterations);
  add("squeezed", name, {"worst density", most});
  add("squeezed", name, {"width", wide, std::sqrt(1 / 0.8)});
  add("squeezed", name, {"mean way left [h]", left});
}

void pool(float alpha, const Iterations& iterations, int threads, const AddNumber& add) {
  Simulation s(solver(iterations, threads));
  s.add_collider({.shape = Box{{-5, -5, 0}, {5, 5, 99}, true}, .friction = 0.3f});
  s.add_body(sample(Lattice{.count = {10, 10, 12}, .corner = {-5, -5, 4}, .jitter = 0.1f}), {.alpha = alpha});
  s.advance(600 * 0.15);
  const std::span<const float> z = s.positions().z();
  const double depth = 2 * std::accumulate(z.begin(), z.end(), 0.0) / static_cast<double>(z.size());
  add("pool", setting(alpha, iterations), {"depth [h]", depth, 12.0});
}

/// A cube that turns and is pressed together while nothing acts from outside.
void keep_momentum(float alpha, int threads, const AddNumber& add) {
  constexpr int k_steps = 1000;
  SolverConfig config = solver({2}, threads);
  config.gravity = {0, 0, 0};
  Simulation s(config);
  Body body = sample(Lattice{.count = {8, 8, 8}, .corner = {-4, -4, -4}, .jitter = 0.1f});
  for (const Vec3& x : body.positions)
    body.velocities.push_back(Vec3(0.01f, 0.02f, 0) + Vec3(0.02f, 0, 0.05f).cross(x) - 0.1f * x);
  s.add_body(body, {.alpha = alpha, .update_threshold = 1e6f, .deformation_damping = 0.0f});
  s.prepare();
  using Vec = Eigen::Vector3d;
  double pace = 0, turns = 0;
  const auto sums = [&](Vec& momentum, Vec& spin) {
    momentum = spin = Vec::Zero();
    pace = turns = 0;
    for (std::size_t row = 0; row < s.particle_count(); ++row) {
      const Vec x = s.positions()[row].cast<double>(), v = s.velocities()[row].cast<double>();
      momentum += v, spin += x.cross(v);
      pace += v.norm(), turns += x.norm() * v.norm();
    }
  };
  Vec momentum, spin, later_momentum, later_spin;
  sums(momentum, spin);
  const double at_start = pace, turns_at_start = turns;
  for (int k = 0; k < k_steps; ++k) s.step();
  sums(later_momentum, later_spin);
  const std::string name = setting(alpha, {2});
  add("momentum in 1,000 steps", name,
      {"momentum lost, of the sum of all", (later_momentum - momentum).norm() / at_start});
  add("momentum in 1,000 steps", name,
      {"spin lost, of the sum of all", (later_spin - spin).norm() / turns_at_start});
}

}  // namespace

void measure_volume(int threads, const AddNumber& add) {
  for (const float alpha : k_alphas)
    for (const Iterations& iterations : k_iterations) {
      if (alpha != k_squeezed_only) drop(alpha, iterations, threads, add);
      if (alpha < 1) squeeze(alpha, iterations, threads, add);
      if (alpha > 0.5f && alpha != k_squeezed_only) pool(alpha, iterations, threads, add);
    }
  for (const float alpha : {0.0f, 0.3f, 0.7f, 1.0f}) keep_momentum(alpha, threads, add);
}

}  // namespace mallow::bench

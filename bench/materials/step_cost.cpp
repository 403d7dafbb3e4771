#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "harness/statistics.h"
#include "mallow/simulation.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

constexpr int k_side = 22, k_blocks = 40, k_block_steps = 10;

/// Of each step [ms]: processor time of all of it, as others use the machine too, and wall time of phases, of
/// which the least counts.
struct Times {
  std::vector<double> step, density, volume;
  double iterations = 0;  ///< a step
};

/// A few steps of one, a few of the next: what else the machine does slows all of them.
std::vector<Times> in_turn(std::vector<Simulation>& simulations) {
  std::vector<Times> times(simulations.size());
  for (int block = 0; block < k_blocks; ++block)
    for (std::size_t k = 0; k < simulations.size(); ++k)
      for (int step = 0; step < k_block_steps; ++step) {
        const std::clock_t start = std::clock();
        const StepReport report = simulations[k].step();
        times[k].step.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        times[k].iterations += 1.0 * report.volume_iterations / (k_blocks * k_block_steps);
        times[k].density.push_back(1e3 * report.seconds[static_cast<std::size_t>(Phase::density)]);
        times[k].volume.push_back(1e3 * report.seconds[static_cast<std::size_t>(Phase::volume)]);
      }
  return times;
}

SolverConfig solver(float gravity, int volume_iterations, int threads) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, -gravity},
          .update_period = 9.0f,
          .volume_iterations = volume_iterations,
          .sleep_speed = 0.0f,
          .threads = threads};
}

/// Waves half as long as the cube, which strain it by less than 0.01.
Vec3 stirred(const Vec3& x) {
  const float wave = std::numbers::pi_v<float> / static_cast<float>(k_side);
  return 0.02f * Vec3(2 * std::sin(wave * x.z()), std::cos(wave * x.x()), -std::cos(2 * wave * x.y()));
}

Simulation swinging(const Material& material, int threads) {
  Simulation s(solver(0, 0, threads));
  Body body = sample(Lattice{.count = {k_side, k_side, k_side}});
  for (const Vec3& x : body.positions) body.velocities.push_back(stirred(x));
  s.add_body(body, material);
  return s;
}

Simulation dropped(const Material& material, float speed, int threads) {
  Simulation s(solver(0.1f, 0, threads));
  Body body = sample(Lattice{.count = {k_side, k_side, k_side}});
  body.velocity = {0, 0, -speed};
  s.add_body(body, material);
  s.add_collider({.shape = Plane{{0, 0, 1}, -1.0f}, .friction = 0.5f});
  return s;
}

/// At rest under its own weight, which iterations have to bear in every step.
Simulation resting(int volume_iterations, int threads) {
  Simulation s(solver(0.3f, volume_iterations, threads));
  s.add_body(sample(Lattice{.count = {k_side, k_side, k_side}}), {.alpha = 0.7f, .update_threshold = 1e30f});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  for (int k = 0; k < 100; ++k) s.step();
  return s;
}

const Material k_elastic{.alpha = 0.0f, .update_threshold = 1e30f, .deformation_damping = 0.0f};

struct Motion {
  const char* name;
  float speed;  ///< at which it hits a floor [m/s]; 0: it swings in the air
  float yield;
  std::optional<float> creep;
};
constexpr Motion k_motions[] = {{"swings below yield", 0, 0.08f, {}},
                                {"creeps, dropped at 1 h/s", 1, 0.02f, 0.02f},
                                {"flows, dropped at 3 h/s", 3, 0.05f, {}}};

void cost_of_yield(int threads, const AddNumber& add) {
  for (const Motion& motion : k_motions) {
    Material yielding = k_elastic;
    yielding.update_threshold.reset();
    yielding.plastic_yield = motion.yield;
    yielding.plastic_creep = motion.creep;
    std::vector<Simulation> both;
    for (const Material& material : {k_elastic, yielding})
      both.push_back(motion.speed > 0 ? dropped(material, motion.speed, threads)
                                      : swinging(material, threads));
    const std::vector<Times> times = in_turn(both);
    add("cost of yield", motion.name,
        {"median step, of an elastic one", median(times[1].step) / median(times[0].step), {}});
    add("cost of yield", motion.name,
        {"mean step with new frames, of an elastic one", mean(times[1].step) / mean(times[0].step), {}});
  }
}

void cost_of_damping(int threads, const AddNumber& add) {
  std::vector<Simulation> damped;
  for (const float damping_time : {0.0f, 0.1f})
    for (const float deformation_damping : {0.0f, 0.1f}) {
      Material material = k_elastic;
      if (damping_time > 0) material.damping_time = damping_time;
      material.deformation_damping = deformation_damping;
      damped.push_back(swinging(material, threads));
    }
  const std::vector<Times> times = in_turn(damped);
  constexpr const char* k_names[] = {"none", "deformation_damping", "damping_time", "both"};
  for (std::size_t k = 1; k < damped.size(); ++k)
    add("cost of damping", k_names[k],
        {"median step, of one without", median(times[k].step) / median(times[0].step), {}});
}

void cost_of_volume(int threads, const AddNumber& add) {
  constexpr const char* k_test = "cost of volume at alpha 0.7";
  std::vector<Simulation> kept;
  for (const int iterations : {0, 1, 2}) kept.push_back(resting(iterations, threads));
  const std::vector<Times> times = in_turn(kept);
  for (std::size_t k = 1; k < kept.size(); ++k) {
    const std::string name = std::to_string(k) + (k == 1 ? " iteration" : " iterations");
    add(k_test, name, {"taken a step", times[k].iterations, {}});
    add(k_test, name, {"median step, of one without", median(times[k].step) / median(times[0].step), {}});
  }
  // What the second adds: contact for a trial, and a sum each way. The first also finds how particles
  // respond.
  const double density = minimum(times[2].density), first = minimum(times[1].volume);
  add(k_test, "the first iteration", {"of a density pass each way", first / (2 * density), {}});
  add(k_test, "one more iteration",
      {"of a density pass each way", (minimum(times[2].volume) - first) / (2 * density), {}});
  add(k_test, "density", {"pass [ms]", density, {}});
}

}  // namespace

void measure_cost(int threads, const AddNumber& add) {
  cost_of_yield(threads, add);
  cost_of_damping(threads, add);
  cost_of_volume(threads, add);
}

}  // namespace mallow::bench

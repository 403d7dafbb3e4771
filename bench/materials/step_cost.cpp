#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "harness/statistics.h"
#include "mallow/simulation.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

constexpr int k_side = 22, k_blocks = 40, k_block_steps = 10;

struct Motion {
  const char* name;
  float speed;  ///< at which it hits a floor [m/s]; 0: it swings in the air
  float yield;
  std::optional<float> creep;
};
constexpr Motion k_motions[] = {{"swings below yield", 0, 0.08f, {}},
                                {"creeps, dropped at 1 h/s", 1, 0.02f, 0.02f},
                                {"flows, dropped at 3 h/s", 3, 0.05f, {}}};

/// Waves half as long as the cube, which strain it by less than 0.01.
Vec3 stirred(const Vec3& x) {
  const float wave = std::numbers::pi_v<float> / static_cast<float>(k_side);
  return 0.02f * Vec3(2 * std::sin(wave * x.z()), std::cos(wave * x.x()), -std::cos(2 * wave * x.y()));
}

Simulation cube(const Motion& motion, bool yields, int threads) {
  const bool drops = motion.speed > 0;
  Simulation s({.time_step = 0.15f,
                .support_radius = 2.1f,
                .gravity = {0, 0, drops ? -0.1f : 0.0f},
                .update_period = 9.0f,
                .volume_iterations = 0,
                .sleep_speed = 0.0f,
                .threads = threads});
  Material material{.alpha = 0.0f, .deformation_damping = 0.0f};
  if (yields) {
    material.plastic_yield = motion.yield;
    material.plastic_creep = motion.creep;
  } else {
    material.update_threshold = 1e30f;
  }
  Body body = sample(Lattice{.count = {k_side, k_side, k_side}});
  body.velocity = {0, 0, -motion.speed};
  if (!drops)
    for (const Vec3& x : body.positions) body.velocities.push_back(stirred(x));
  s.add_body(body, material);
  if (drops) s.add_collider({.shape = Plane{{0, 0, 1}, -1.0f}, .friction = 0.5f});
  return s;
}

}  // namespace

void measure_yield_cost(int threads, const AddNumber& add) {
  for (const Motion& motion : k_motions) {
    Simulation elastic = cube(motion, false, threads), yielding = cube(motion, true, threads);
    std::vector<double> without, with;
    // A few steps of one, a few of the other: what else the machine does slows both.
    for (int block = 0; block < k_blocks; ++block)
      for (const auto& [s, times] : {std::pair{&elastic, &without}, std::pair{&yielding, &with}})
        for (int k = 0; k < k_block_steps; ++k) times->push_back(milliseconds([&, s = s] { s->step(); }));
    add("cost of yield", motion.name, {"median step, of an elastic one", median(with) / median(without), {}});
    add("cost of yield", motion.name,
        {"mean step with new frames, of an elastic one", mean(with) / mean(without), {}});
  }
}

}  // namespace mallow::bench

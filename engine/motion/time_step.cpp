#include "motion/time_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "motion/motion_lanes.h"

namespace mallow {

namespace {

/// The first row of [begin, end) that is as fast as the fastest of them: the first such stretch of rows, then
/// the first in it.
std::size_t row_of(float squared_velocity, const ForcesInput& forces, const MotionLanes& lanes,
                   std::size_t begin, std::size_t end) {
  for (const std::size_t stretch : {k_lanes, std::size_t{1}}) {
    const auto holds_it = [&](std::size_t i) {
      const float here = lanes.fastest(forces, i, std::min(end, i + stretch));
      return here == squared_velocity || std::isnan(here);
    };
    while (begin + stretch < end && !holds_it(begin)) begin += stretch;
  }
  return begin;
}

/// In a full body viscosity takes 25 μ/(ρ0 σ²) of a particle's velocity relative to its neighbours a second,
/// where they move along the line to it: five times the integral of ∇²W, the bound of Gershgorin. Steps
/// longer than 2 over twice that rate amplify such motion. [model 2, section 0]
constexpr double k_viscous_share = 1.0 / 25;

/// Pressure is a spring that a step must not overshoot, beside shape matching, which is one too. With
/// x = α k Δt²/σ² and a = (1 − α) Δt²/(Δt0 Δt_SM), simulations of 2,500 steps at α 0.3 and 0.7, a 0.3 to 2.5,
/// kept their energy up to 2 x + a = 3.75 and gained it from 4; at x 1.4 beside any a up to 1, and in fluids
/// up to 1.4 too. That takes viscosity: with none they gained from x = 0.2 on, and with α μ Δt/(ρ0 σ²) = y
/// from 0.1 + 880 y. Damping takes its part of what a step carries: the pull counts 1 + 2 τ/Δt times, and of
/// the 4 of linear theory 2 (1 − exp(−ζ Δt)) are gone (config/validation.cpp), and as much for the share that
/// viscosity takes. `mallow-bench stability` goes through them.
constexpr double k_most_pressure = 1.4, k_most_together = 3.4, k_least_pressure = 0.05,
                 k_pressure_by_viscosity = 800;

/// Pressure that draws counts by itself too. A block of fluid at rest, with cohesion and a k of 1.2 to
/// 4 σ²/Δt0², was thrown apart at 2 to 8 m/s without a limit; with 0.2 it moves at 0 to 0.1, with 0.4 at up to
/// 0.26. Beyond that k it clumps in any step.
constexpr double k_most_pull = 0.2;

/// longest: Δt at most [s].
double pressure_limit(const TimeStepLimits::Pressure& pressure, double support_radius, double longest) {
  if (!(pressure.coefficient > 0)) return std::numeric_limits<double>::infinity();
  const double square = support_radius * support_radius;
  const double x = static_cast<double>(pressure.coefficient) / square;  // by Δt²
  const double y = k_pressure_by_viscosity * static_cast<double>(pressure.kinematic_viscosity) / square;
  // The root of x Δt² = k_least_pressure + y Δt.
  const double calmed = (y + std::sqrt(y * y + 4 * x * k_least_pressure)) / (2 * x);
  const double pull = static_cast<double>(pressure.stiffness);
  const double damped = static_cast<double>(pressure.damping_time) * pull;
  // The root of (2 x + pull) Δt² + 2 τ pull Δt = most.
  const auto root = [&](double most) {
    return (std::sqrt(damped * damped + (2 * x + pull) * most) - damped) / (2 * x + pull);
  };
  double together = root(k_most_together);
  const double rate = static_cast<double>(pressure.damping_rate);
  if (damped > 0 || rate > 0) {
    const double step = std::min(longest, together);
    const double drag = static_cast<double>(pressure.kinematic_viscosity) / (k_viscous_share * square);
    const double taken = 1 - std::exp(-rate * step) + std::min(1.0, drag * step);
    together = root(k_most_together * (1 - 0.5 * taken));
  }
  const double drawn = pressure.pull > 0 ? std::sqrt(k_most_pull * square / static_cast<double>(pressure.pull))
                                         : std::numeric_limits<double>::infinity();
  return std::min({calmed, together, std::sqrt(k_most_pressure / x), drawn});
}

}  // namespace

Fastest fastest_particle(const ParticleStore& store, const Execution& execution, FastestInput& in) {
  const MotionLanes& lanes = MALLOW_SELECT(execution.level, motion_lanes);
  const auto forces = [&](const FastestInput::Body& body) {
    return ForcesInput{.position = {},
                       .velocity = raw(store.velocity),
                       .sph_acceleration = in.sph_acceleration ? raw(*in.sph_acceleration) : ConstVectors{},
                       .cross_group = in.cross_group ? raw(*in.cross_group) : ConstVectors{},
                       .walls = in.walls ? raw(*in.walls) : ConstVectors{},
                       .user = in.user ? raw(*in.user) : ConstVectors{},
                       .pull = {},
                       .group_begin = 0,
                       .pin = store.pin.empty() ? nullptr : store.pin.data(),
                       .gravity = {in.gravity[0], in.gravity[1], in.gravity[2]},
                       .time_step = in.time_step,
                       .sph_factor = body.share,
                       .elastic_factor = 0};
  };
  in.blocks.clear();
  for (const FastestInput::Body& body : in.bodies) in.blocks.add(body.end - body.begin);
  in.partial.resize(in.blocks.blocks.size());
  // Of each block the speed; only the winning block is searched for the row.
  parallel_for(execution.threads, in.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const FastestInput::Body& body = in.bodies[block.range];
    in.partial[number] = {lanes.fastest(forces(body), body.begin + block.begin, body.begin + block.end), 0};
  });
  Fastest fastest;
  std::size_t winner = 0;
  for (std::size_t b = 0; b < in.partial.size(); ++b) {
    // Not `>`: a velocity that is not a number must win, so that it is seen.
    if (in.partial[b].squared_velocity <= fastest.squared_velocity || std::isnan(fastest.squared_velocity))
      continue;
    fastest = in.partial[b];
    winner = b;
  }
  if (in.partial.empty()) return fastest;
  const RangeBlocks::Block& block = in.blocks.blocks[winner];
  const FastestInput::Body& body = in.bodies[block.range];
  fastest.row = static_cast<std::uint32_t>(row_of(fastest.squared_velocity, forces(body), lanes,
                                                  body.begin + block.begin, body.begin + block.end));
  return fastest;
}

double limited_time_step(const TimeStepLimits& limits, double max_velocity) {
  // V a little above 0.999 σ/Δt0 is where [TK eq. 12] starts to act; 0.999 makes its "<" hold.
  const double radius = static_cast<double>(limits.support_radius);
  double step = static_cast<double>(limits.time_step);
  if (max_velocity > 0) step = std::min(step, 0.999 * static_cast<double>(limits.farthest) / max_velocity);
  if (!limits.acoustic) return step;
  for (const TimeStepLimits::Pressure& pressure : limits.pressures)
    step = std::min(step, pressure_limit(pressure, radius, static_cast<double>(limits.time_step)));
  step = std::min(step, k_viscous_share * static_cast<double>(limits.viscous_time));
  return step;
}

double steps_until(double left, double longest) {
  // Δt0 is a float, and what is asked for may be a decimal: they differ by 6e-8 of either.
  constexpr double k_rounding = 1e-6;
  return std::max(1.0, std::ceil(left / longest * (1 - k_rounding)));
}

float share_of(double left, double steps) {
  // Contact divides by Δt: a time so short that no float holds it still is a step.
  return std::max(static_cast<float>(left / steps), std::numeric_limits<float>::min());
}

}  // namespace mallow

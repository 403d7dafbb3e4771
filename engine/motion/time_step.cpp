#include "motion/time_step.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace mallow {

Fastest fastest_particle(const ParticleStore& store, float time_step, const VectorColumn& sph_acceleration,
                         const Vec3& gravity, const VectorColumn* cross_group, const VectorColumn* user,
                         int threads, std::vector<Fastest>& partial) {
  const auto faster = [](const Fastest& a, const Fastest& b) {
    // Not `>`: a velocity that is not a number must win, so that it is seen.
    return b.squared_velocity <= a.squared_velocity || std::isnan(a.squared_velocity) ? a : b;
  };
  return parallel_reduce(
      threads, store.size(), partial, Fastest{},
      [&](std::size_t begin, std::size_t end) {
        Fastest best;
        for (std::size_t i = begin; i < end; ++i) {
          if (!store.pin.empty() && store.pin[i] != 0) continue;
          Vec3 acceleration = sph_acceleration.get(i) + gravity;
          if (cross_group) acceleration += cross_group->get(i);
          if (user) acceleration += user->get(i);
          const Vec3 velocity = store.velocity.get(i) + time_step * acceleration;
          best = faster(best, {velocity.squaredNorm(), static_cast<std::uint32_t>(i)});
        }
        return best;
      },
      faster);
}

double limited_time_step(const TimeStepLimits& limits, double max_velocity) {
  // V a little above 0.999 σ/Δt0 is where [TK eq. 12] starts to act; 0.999 makes its "<" hold.
  const double radius = static_cast<double>(limits.support_radius);
  double step = static_cast<double>(limits.time_step);
  if (max_velocity > 0) step = std::min(step, 0.999 * radius / max_velocity);
  if (limits.acoustic) {
    const double speed = static_cast<double>(limits.sound_speed) + max_velocity;
    if (speed > 0) step = std::min(step, 0.4 * radius / speed);
    step = std::min(step, 0.125 * static_cast<double>(limits.viscous_time));
  }
  return step;
}

}  // namespace mallow

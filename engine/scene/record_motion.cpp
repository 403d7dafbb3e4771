#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "mallow/errors.h"
#include "mallow/tuning.h"

namespace mallow {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double mean(const std::vector<double>& values, double of_none) {
  return values.empty()
             ? of_none
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Volume of the particles of a body; where they are less dense than at rest, as they are at a surface, they
/// count as at rest.
double volume(const Simulation& simulation, const Simulation::Rows& rows, const BodyInfo& body) {
  const double mass = static_cast<double>(body.particle_mass);
  const double at_rest = mass / static_cast<double>(body.rest_density);
  const std::span<const float> densities = simulation.densities();
  if (densities.size() < rows.end) return at_rest * static_cast<double>(rows.end - rows.begin);
  double sum = 0;
  for (std::size_t row = rows.begin; row < rows.end; ++row)
    sum += std::min(at_rest, mass / static_cast<double>(densities[row]));
  return sum;
}

MotionMoment moment_of(Simulation& simulation, const MotionPlan& plan) {
  MotionMoment moment{.particles = snapshot(simulation)};
  const SimulationInfo info = simulation.info();
  const std::vector<BodyId> bodies = simulation.bodies();
  const VectorView x = simulation.positions();
  double mass = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Simulation::Rows rows = simulation.rows(bodies[b]);
    const double m = static_cast<double>(info.bodies[b].particle_mass);
    moment.volume += volume(simulation, rows, info.bodies[b]);
    for (std::size_t row = rows.begin; row < rows.end; ++row) {
      const Eigen::Vector3d position = x[row].cast<double>();
      moment.center += m * position;
      mass += m;
      low = std::min(low, position.z());
      high = std::max(high, position.z());
    }
  }
  if (mass > 0) {
    moment.center /= mass;
    moment.height = high - low;
    double sum = 0;
    for (std::size_t row = 0; row < x.size(); ++row)
      sum += (x[row].cast<double>() - moment.center).head<2>().squaredNorm();
    moment.spread = std::sqrt(sum / static_cast<double>(x.size()));
  }
  const Energy energy = simulation.energy();
  moment.kinetic_energy = energy.kinetic;
  moment.energy = energy.kinetic + energy.gravity + energy.elastic;
  for (const auto& measure : plan.measures) moment.measures.push_back(measure(simulation));
  return moment;
}

void note_spacings(const Simulation& simulation, Motion& motion) {
  for (const BodyId body : simulation.bodies()) {
    const std::size_t slot = slot_of(body);
    if (motion.spacings.size() <= slot) motion.spacings.resize(slot + 1, 1.0f);
    motion.spacings[slot] = simulation.spacing(body);
  }
}

/// Whether a frame is one of `moments` that are as even as they come, from 1 to `frames`.
bool is_recorded(int frame, const MotionPlan& plan) {
  const auto place = [&](int f) {
    return static_cast<std::int64_t>(f) * std::min(plan.moments, plan.frames) / plan.frames;
  };
  return place(frame) > place(frame - 1);
}

/// The steps of a frame; false where the plan says stop.
bool run_frame(Simulation& simulation, double end, const MotionPlan& plan, Motion& motion) {
  double seconds = 0;
  while (simulation.time() < end) {
    if (plan.stop && plan.stop()) return false;
    const double start = now();
    simulation.step_towards(end);
    seconds += now() - start;
    ++motion.steps;
  }
  motion.frame_seconds.push_back(seconds);
  return true;
}

void run_frames(Simulation& simulation, const MotionPlan& plan, Motion& motion) {
  const double begin = simulation.time();
  for (int frame = 1; frame <= plan.frames; ++frame) {
    if (!run_frame(simulation, begin + frame * plan.frame_time, plan, motion)) return;
    if (!is_recorded(frame, plan)) continue;
    if (plan.draw) {
      const double start = now();
      plan.draw(simulation);
      motion.draw_seconds.push_back(now() - start);
    }
    note_spacings(simulation, motion);
    motion.moments.push_back(moment_of(simulation, plan));
  }
}

void check(const MotionPlan& plan) {
  if (plan.frames < 0) throw ConfigError("frames", std::to_string(plan.frames) + " is not allowed: >= 0");
  if (!(plan.frame_time > 0) || !std::isfinite(plan.frame_time))
    throw ConfigError("frame_time", std::to_string(plan.frame_time) + " is not allowed: a number > 0");
  if (plan.moments < 1) throw ConfigError("moments", std::to_string(plan.moments) + " is not allowed: >= 1");
}

/// act: records into a motion.
template <class Act>
Motion timed(const Act& act) {
  Motion motion;
  const double start = now();
  try {
    act(motion);
  } catch (const Error& error) {
    motion.failure = error.what();
  }
  motion.other_seconds = now() - start -
                         std::accumulate(motion.frame_seconds.begin(), motion.frame_seconds.end(), 0.0) -
                         std::accumulate(motion.draw_seconds.begin(), motion.draw_seconds.end(), 0.0);
  return motion;
}

void record(Simulation& simulation, const MotionPlan& plan, Motion& motion) {
  simulation.prepare();
  note_spacings(simulation, motion);
  motion.moments.push_back(moment_of(simulation, plan));
  run_frames(simulation, plan, motion);
}

}  // namespace

double Motion::seconds_per_frame() const {
  return mean(frame_seconds, std::numeric_limits<double>::quiet_NaN());
}

double Motion::draw_seconds_per_frame() const {
  return mean(draw_seconds, 0);
}

Motion record_motion(const std::function<Simulation()>& build, const MotionPlan& plan) {
  check(plan);
  return timed([&](Motion& motion) {
    Simulation simulation = build();
    record(simulation, plan, motion);
  });
}

Motion record_motion(Simulation& simulation, const MotionPlan& plan) {
  check(plan);
  return timed([&](Motion& motion) { record(simulation, plan, motion); });
}

}  // namespace mallow

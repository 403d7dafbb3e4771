#include "stability/trial.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>

namespace mallow::bench {
namespace {

struct Sums {
  double kinetic = 0, potential = 0, speed = 0, moment = 0;
  Eigen::Vector3d momentum{0, 0, 0}, angular{0, 0, 0};
  bool finite = true;
};

Sums sums(const Simulation& simulation, const Trial& trial) {
  Sums s;
  const VectorView x = simulation.positions(), v = simulation.velocities();
  const Eigen::Vector3d gravity = simulation.config().gravity.cast<double>();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector3d xi = x[i].cast<double>(), vi = v[i].cast<double>();
    const double m = static_cast<double>(i < trial.other_begin ? trial.mass : trial.other_mass);
    s.finite = s.finite && xi.allFinite() && vi.allFinite();
    s.kinetic += 0.5 * m * vi.squaredNorm();
    s.potential += m * gravity.norm() * (xi.z() - static_cast<double>(trial.floor));
    s.momentum += m * vi;
    s.angular += m * xi.cross(vi);
    s.speed += m * vi.norm();
    s.moment += m * xi.norm() * vi.norm();
  }
  return s;
}

/// Steps from one look at the conserved energy to the next, which takes longer than a step.
constexpr int k_look_interval = 5;

/// The state after so many steps, which are taken on other threads, and by a restored simulation from the
/// middle on.
std::uint64_t hash_again(const Trial& trial, int steps) {
  Simulation simulation = trial.build();
  simulation.prepare();
  for (int step = 0; step < steps; ++step) {
    if (step == steps / 2) simulation = Simulation::restore(simulation.save(), 3);
    if (trial.before_step) trial.before_step(simulation, step);
    simulation.step();
  }
  return simulation.state_hash();
}

double ratio(double value, double reference) {
  return reference > 0 ? value / reference : value;
}

}  // namespace

const char* name(Verdict verdict) {
  constexpr const char* k_names[] = {"stable", "limited", "refused", "unstable"};
  return k_names[static_cast<std::size_t>(verdict)];
}

Outcome run(const Trial& trial) {
  Outcome outcome;
  int limited = 0;
  try {
    Simulation simulation = trial.build();
    simulation.prepare();
    const Sums start = sums(simulation, trial);
    const double reference = start.kinetic + start.potential;
    const double n = static_cast<double>(simulation.particle_count());
    double conserved = 0;
    try {
      for (; outcome.steps < trial.steps; ++outcome.steps) {
        if (trial.before_step) trial.before_step(simulation, outcome.steps);
        limited += simulation.step().limited;
        const Sums now = sums(simulation, trial);
        if (!trial.by_conserved_energy) {
          outcome.energy = std::max(outcome.energy, ratio(now.kinetic + now.potential, reference));
        } else if (now.finite && outcome.steps % k_look_interval == 0) {
          const double energy = simulation.energy().conserved;
          if (outcome.steps == 0) conserved = energy;
          outcome.energy = std::max(outcome.energy, ratio(energy, conserved));
        }
        if (now.finite && outcome.energy <= 1 + trial.energy_room) continue;
        outcome.verdict = Verdict::unstable;
        break;
      }
    } catch (const StepError& error) {
      outcome.verdict = Verdict::refused;
      outcome.message = error.what();
    }
    if (trial.compares_bits && outcome.steps == trial.steps &&
        hash_again(trial, trial.steps) != simulation.state_hash()) {
      outcome.verdict = Verdict::unstable;
      outcome.message = "other threads and a restored state end in other bits";
    }
    const Sums end = sums(simulation, trial);
    if (!end.finite) outcome.verdict = Verdict::unstable;
    outcome.end_energy = ratio(end.kinetic, reference);
    outcome.end_speed = std::sqrt(2 * end.kinetic / (static_cast<double>(trial.mass) * n)) *
                        static_cast<double>(*simulation.config().time_step / trial.spacing);
    if (trial.is_free) {
      outcome.momentum_drift = ratio((end.momentum - start.momentum).norm(), start.speed);
      if (trial.other_begin == SIZE_MAX)
        outcome.angular_drift = ratio((end.angular - start.angular).norm(), start.moment);
    }
  } catch (const ConfigError& error) {
    outcome.verdict = Verdict::refused;
    outcome.message = error.what();
  } catch (const std::exception& error) {
    outcome.verdict = Verdict::unstable;
    outcome.message = error.what();
  }
  outcome.limited_share = outcome.steps > 0 ? static_cast<double>(limited) / outcome.steps : 0;
  if (outcome.verdict == Verdict::stable && limited > 0) outcome.verdict = Verdict::limited;
  return outcome;
}

}  // namespace mallow::bench

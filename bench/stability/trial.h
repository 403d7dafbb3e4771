#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mallow/simulation.h"

namespace mallow::bench {

/// How a trial ended.
enum class Verdict {
  stable,    ///< bounded, with the steps that were asked for
  limited,   ///< bounded, because steps were shortened [TK eq. 12]
  refused,   ///< stopped with an error that says what to change, at a state that is still good
  unstable,  ///< energy from nowhere, or numbers that are none
};
const char* name(Verdict verdict);

/// A simulation that is pushed to where it might break.
struct Trial {
  std::function<Simulation()> build = {};
  int steps = 300;
  /// Called before every step.
  std::function<void(Simulation&, int step)> before_step = {};
  float spacing = 1;     ///< of the particles [m], what distances are compared with
  float mass = 1;        ///< of a particle [kg]
  float other_mass = 1;  ///< of one of a second body, whose rows begin at `other_begin` [kg]
  std::size_t other_begin = SIZE_MAX;
  float floor = 0;       ///< height that nothing falls below [m]; where there is gravity
  bool is_free = false;  ///< nothing acts from outside: momentum has to stay, and spin
                         ///< where there is one body: those that touch rub between points apart
  /// Work that something outside may do on the particles, relative to their energy at the start. 0.5 leaves
  /// room for what falls onto others.
  double energy_room = 0.5;
  /// Energy is what Simulation::energy() says a step conserves, looked at every few steps, not ½ m v² + m g
  /// z.
  bool by_conserved_energy = false;
  /// It is run once more with other threads, saved and restored half way: what ends in other bits is
  /// unstable.
  bool compares_bits = false;
};

struct Outcome {
  Verdict verdict = Verdict::stable;
  std::string message = {};   ///< of the error, where it was refused
  int steps = 0;              ///< that were taken
  double limited_share = 0;   ///< of the steps
  double energy = 0;          ///< the largest of the motion, relative to that at the start
  double end_energy = 0;      ///< kinetic energy at the end, likewise
  double momentum_drift = 0;  ///< |Δ Σ m v| over Σ m |v| at the start; where nothing acts from outside
  double angular_drift = 0;   ///< |Δ Σ m x × v| over Σ m |x| |v| likewise
  double end_speed = 0;       ///< root mean square, in spacings a step
};

/// Runs a trial. Never throws what a simulation throws.
Outcome run(const Trial& trial);

}  // namespace mallow::bench

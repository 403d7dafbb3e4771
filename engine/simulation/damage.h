#pragma once

#include <cstdint>
#include <optional>
#include <sstream>

#include "mallow/simulation.h"

namespace mallow {

/// A number that is not finite.
struct Damage {
  Phase phase;         ///< that wrote it
  const char* column;  ///< "pressure" and the like
  std::uint32_t row;   ///< whose it is; a region's owner, or with a stride above 1 one of its particles
};

/// The first number that is not finite: in what a step starts from, else in the columns of phases up to
/// `last` in their order, so that what was computed from another such number comes after it. Lanes do not
/// look for them; they hand them on to where choose_time_step() or move_bodies() cannot miss them.
std::optional<Damage> find_damage(const Simulation::State& state, Phase last);

/// Throws StepError where the state that a step starts from has such a number.
void check_damage(const Simulation::State& state);
/// Throws StepError that names the first such number up to `phase`. row: whose velocity or position would not
/// be finite after it, where nothing else is to blame.
[[noreturn]] void refuse_damage(const Simulation::State& state, Phase phase, std::uint32_t row);
/// "step 3: particle 42 at (1 2 3) "
std::ostringstream describe_particle(const Simulation::State& state, std::uint32_t row);

}  // namespace mallow

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "stability/trial.h"

namespace mallow::bench {

/// A setting that a hypercube turns, from 0 to 1.
struct TurnedKnob {
  std::string name;  ///< with what the ends stand for
  float turn;        ///< in this trial
  std::string value;
};

/// A body with all its knobs turned at once.
struct Mixture {
  std::vector<TurnedKnob> knobs;
  Trial trial;
};

/// A Latin hypercube of modulus, yield, creep, damping, volume, temperature and what goes with them: cut into
/// `count` equal parts, the range of each knob is used in every part once [McKay, Beckman & Conover 1979].
/// The same for the same seed on any machine.
std::vector<Mixture> hypercube(std::size_t count, std::uint32_t seed);

/// A strip for each knob, from one end to the other, with a line for each mixture.
void write_hypercube(const std::filesystem::path& svg, const std::vector<Mixture>& mixtures,
                     const std::vector<Outcome>& outcomes);

}  // namespace mallow::bench

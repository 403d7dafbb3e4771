#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mallow/simulation.h"

namespace mallow::tradeoff {

/// A number of a run that a user names: "height(body)".
struct Measure {
  std::string name;
  std::function<double(Simulation&)> value;
};
/// "what(body)". simulation: of the scene, whose bodies the text may name by name or
/// number. Throws ConfigError that names what there is.
Measure parse_measure(const std::string& text, const Simulation& simulation);

}  // namespace mallow::tradeoff

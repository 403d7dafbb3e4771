#pragma once

#include <string>
#include <vector>

#include "stability/trial.h"

namespace mallow::bench {

/// One thing taken to its end.
struct Extreme {
  std::string name;  ///< "velocities of 1e6"
  float alpha;
  Trial trial;
};

/// Each with a solid (alpha 0), a paste (0.5) and a fluid (1). long_steps: of the cube that rests.
std::vector<Extreme> extremes(int long_steps);

}  // namespace mallow::bench

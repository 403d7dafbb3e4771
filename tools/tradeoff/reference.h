#pragma once

#include <functional>
#include <string>

#include "tradeoff/runner.h"

namespace mallow::tradeoff {

/// What a reference is looked for with.
struct ReferenceSearch {
  const Scene& scene;
  const Motion& plain;  ///< the scene as it is
  double plain_cost;    ///< wall time of that run [s]
  double until, end;    ///< wall_clock() by which a run more has to have ended, and at which one is ended
  std::function<void(const std::string& what)> say;
};
/// Halves the step until that changes little, or the time is up. Throws Stopped.
Reference find_reference(const ReferenceSearch& search, Runner& runner);

}  // namespace mallow::tradeoff

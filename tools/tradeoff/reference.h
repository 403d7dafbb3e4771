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
  double enough;        ///< error of the reference that is asked for [h]; infinity where none is
  double until, end;    ///< wall_clock() by which a run more has to have ended, and at which one is ended
  std::function<void(const std::string& what)> say;
};
/// Halves the step until that changes little and what is left is no more than is enough, or the time is up.
/// Throws Stopped.
Reference find_reference(const ReferenceSearch& search, Runner& runner);
/// Whether a longer search would halve the steps of a scene so many times more.
bool would_go_on(const Reference& reference, const Scene& scene, double halvings);

}  // namespace mallow::tradeoff

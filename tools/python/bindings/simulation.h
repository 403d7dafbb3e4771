#pragma once

#include <memory>
#include <thread>
#include <utility>

#include "errors.h"
#include "live.h"
#include "mallow/errors.h"
#include "mallow/simulation.h"

namespace mallow::python {

/// What one thread may use at a time. The GIL guards the counts: they change while it is held alone.
struct InUse {
  int depth = 0;
  std::thread::id by;
};
/// A use of an object for as long as this lives: throws BusyError where another thread has it. A callback may
/// use what called it again to read, `nested`.
class Use {
 public:
  Use(InUse& object, const char* what, bool nested) : object_(object) {
    const std::thread::id here = std::this_thread::get_id();
    if (object.depth > 0 && object.by != here)
      throw BusyError(std::string(what) + " is in use by another thread: one may use it at a time");
    if (object.depth > 0 && !nested)
      throw ConfigError(what,
                        "is in the middle of a step: its force callback may read it, and change nothing");
    ++object.depth;
    object.by = here;
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  ~Use() { --object_.depth; }

 private:
  InUse& object_;
};

/// A simulation as Python holds it.
struct SimulationCell {
  SimulationCell(Simulation&& made) : simulation(std::move(made)) {}  // NOLINT: what it is made of

  Simulation simulation;
  InUse in_use;
  /// What set_force() was given; here, where the collector of cycles sees it.
  py::object force = py::none();
};

inline Use reading(SimulationCell& cell) {
  return {cell.in_use, "the simulation", true};
}
inline Use changing(SimulationCell& cell) {
  return {cell.in_use, "the simulation", false};
}

/// Spans come as arrays, which are copied.
template <class T>
struct Argument {
  using Type = T;
};
template <>
struct Argument<std::span<const ParticleId>> {
  using Type = const std::vector<ParticleId>&;
};

/// A member of Simulation as one of the class in Python, with the GIL: what it is given cannot change.
template <class R, class... A>
auto verb(R (Simulation::*member)(A...)) {
  return [member](SimulationCell& cell, typename Argument<A>::Type... arguments) -> std::decay_t<R> {
    const Use use = changing(cell);
    return (cell.simulation.*member)(arguments...);
  };
}
template <class R, class... A>
auto query(R (Simulation::*member)(A...) const) {
  return [member](SimulationCell& cell, typename Argument<A>::Type... arguments) -> std::decay_t<R> {
    const Use use = reading(cell);
    return (cell.simulation.*member)(arguments...);
  };
}
/// Without the GIL: for what takes long, and takes numbers alone.
template <class R, class... A>
auto long_verb(R (Simulation::*member)(A...)) {
  return [member](SimulationCell& cell, A... arguments) -> std::decay_t<R> {
    const Use use = changing(cell);
    const py::gil_scoped_release release;
    return (cell.simulation.*member)(arguments...);
  };
}
/// A read that may first prepare what a step would: nobody else may use the object meanwhile.
template <class R, class... A>
auto long_verb(R (Simulation::*member)(A...) const) {
  return [member](SimulationCell& cell, A... arguments) -> std::decay_t<R> {
    const Use use = changing(cell);
    const py::gil_scoped_release release;
    return (cell.simulation.*member)(arguments...);
  };
}

using SimulationClass = py::class_<SimulationCell, std::shared_ptr<SimulationCell>>;
void bind_changes(SimulationClass& simulation);
void bind_steps(SimulationClass& simulation);
void bind_views(SimulationClass& simulation);

}  // namespace mallow::python

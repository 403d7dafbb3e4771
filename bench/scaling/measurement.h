#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "harness/results.h"
#include "mallow/report.h"
#include "scaling/cube.h"

namespace mallow::bench {

/// One run of a cube: means over its steps, the first left out, which also allocates. Runs of all sizes take
/// the same steps, as a body that deforms has other work to do.
struct CubeRun {
  double prepare_ms =
      0;  ///< Simulation::prepare(): what a new reference shape costs, and the first allocations
  double ms_per_step = 0;
  PhaseTimes phase_ms{};                       ///< [ms], not [s]
  std::size_t bytes = 0;                       ///< SimulationInfo::bytes
  std::optional<std::size_t> peak_bytes = {};  ///< resident memory of building and stepping
  std::string state_hash;
};
CubeRun run_cube(const Cube& cube, int threads, int steps);

/// Runs of one cube with one number of threads.
struct Measurement {
  Cube cube;
  int threads = 1;
  int steps = 0;  ///< timed, of each run
  std::vector<CubeRun> runs = {};

  double smallest_ms() const;  ///< per step, of the fastest run
  double smallest_phase_ms(Phase phase) const;
};

/// Runs a cube `repeats` times with every number of threads, in turn, so that what disturbs the machine for a
/// while disturbs all of them. Throws RunFailure where runs do not end in the same state.
std::vector<Measurement> measure(const Cube& cube, const std::vector<int>& threads, int steps, int repeats);

/// What was measured, as a row. single: the same cube with one thread; half: with particles / threads of
/// them, where there is one, for weak scaling.
Json measurement_row(const Measurement& measurement, const Measurement& single, const Measurement* half);

}  // namespace mallow::bench

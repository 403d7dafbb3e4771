#pragma once

#include <functional>
#include <string>

#include "materials/standard_tests.h"

namespace mallow::bench {

/// Takes a number of a test at a setting: "dropped", "alpha 0.3, 2 iterations".
using AddNumber = std::function<void(const char* test, const std::string& setting, const Measured&)>;

/// In units of a spacing of 1, a support radius of 2.1 and a step of 0.15 s.
/// Cubes dropped and squeezed, and a pool, at 0 to 3 volume iterations and at a tolerance; momentum and spin.
void measure_volume(int threads, const AddNumber& add);
/// Bars stretched beyond yield, a dent, small loads, new frames, what is pressed, and drops by the paper's rule.
void measure_yield(int threads, const AddNumber& add);
/// What yielding, damping and volume iterations cost in time.
void measure_cost(int threads, const AddNumber& add);
/// How long a second of toothpaste takes, 10,000 particles and 30 surfaces, by phase.
void measure_realtime(int threads, const AddNumber& add);
/// A slab, a half space, a melting front and a cube in the air.
void measure_heat(int threads, const AddNumber& add);

}  // namespace mallow::bench

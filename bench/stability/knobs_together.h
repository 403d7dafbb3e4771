#pragma once

#include <vector>

#include "stability/extremes.h"

namespace mallow::bench {

/// Knobs that change how matter holds together, turned together: yield, volume, paint, modulus, damping and
/// heat. Each is run a second time with other threads and over a saved state, and has to end in the same
/// bits.
void add_knobs_together(std::vector<Extreme>& list);

}  // namespace mallow::bench

#pragma once

#include "harness/results.h"
#include "table1/paper_rows.h"

namespace mallow::bench {

struct Table1Settings {
  int steps = 240;               ///< of every run, a frame each, as the paper counts
  int repeats = 3;               ///< runs that are timed without surfaces
  int surface_every = 8;         ///< surface and picture are timed at every so manieth frame
  double textbook_seconds = 10;  ///< time that the textbook implementation is given; 0: it does not run
};
Json to_json(const Table1Settings& settings);

/// One row measured: our columns, the paper's and the textbook's. Throws RunFailure where two runs end in
/// different states, which must not be.
Json measure_row(const PaperRow& paper, const Table1Settings& settings, int threads);

}  // namespace mallow::bench

#pragma once

#include <cstddef>
#include <vector>

#include "harness/results.h"
#include "scaling/measurement.h"

namespace mallow::bench {

/// Share of the work that seems to be serial, by Amdahl's law from the times with one thread and with
/// several: t(p)/t(1) = s + (1 − s)/p; of two threads s = 2 t(2)/t(1) − 1. All that does not scale is in it,
/// also memory and caches that threads share; below 0 where noise or a second cache make several threads more
/// than that much faster.
double serial_share(double single_ms, double threads_ms, int threads);

/// Bytes that a step moves at the least per particle, if every phase reads and writes each of its columns and
/// lists once from memory and finds everything else in cache.
double moved_bytes_per_particle(float alpha, double average_neighbors);

/// Rate at which memory is read and written by a = b + c on columns that no cache holds [bytes/s].
double memory_rate(int threads);

/// Memory rates of this machine.
struct MemoryRates {
  double one_thread = 0;   ///< [bytes/s]
  double all_threads = 0;  ///< [bytes/s]
};

/// What 16 and 64 cores might make of a cube, an object per number of cores: Amdahl's law with the share that
/// was measured here, and the time that memory needs at the least, once at this machine's rate and once if
/// every core brought one thread's rate with it.
Json extrapolate(const Measurement& single, const Measurement& several, const MemoryRates& rates);

}  // namespace mallow::bench

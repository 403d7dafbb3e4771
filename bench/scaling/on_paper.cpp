#include "scaling/on_paper.h"

#include <algorithm>

#include "core/column.h"
#include "core/parallel.h"
#include "harness/statistics.h"

namespace mallow::bench {
namespace {

/// Floats of each of the three columns of memory_rate(): 96 MiB, several times what caches hold.
constexpr std::size_t k_rate_floats = std::size_t{24} << 20;
constexpr int k_rate_passes = 5;

/// What a phase moves at the least [bytes].
struct Moved {
  double per_particle;  ///< its columns, each once
  double per_neighbor;  ///< its lists
  bool sph, shape;      ///< whose phase it is; both false: it always runs
};

// Counted in engine/neighbors, sph, motion and shape_matching: 12 for a vector, 64 for a row of sums, 4 for a
// place in a list, 8 for where a list begins and how long it is.
constexpr Moved k_moved[] = {
    {12 + 12 + 4 + (4 + 12 + 4 + 12) + 12 + 8, 4, true, false},  // bounds, count, scatter; lists
    {12 + 8 + 4 + 16, 4, true, false},                           // density
    {4 + 12 + 12 + 8 + 4 + 12 + 12 + 12 + 12, 4, true, false},   // velocities in sorted order; accelerations
    {12 + 12, 0, true, false},                                   // time step
    {12 + 12, 0, false, true},                                   // rigid frame
    {12 + 12 + 4 + 64, 0, false, true},                          // rows of the sums
    {8 + 64 + 64, 4, false, true},                               // sums
    {64 + 64 + 16 + 16 + 12 + 24 + 4 + 1, 0, false, true},       // rotations
    {8 + 64 + 12 + 12 + 4 + 12, 4, false, true},                 // goals
    {12 + 12 + 12 + 12, 0, false, false},                        // motion
    {12, 0, true, false},                                        // its acceleration
    {12, 0, false, true},                                        // its pull
};

constexpr int k_cores[] = {16, 64};

}  // namespace

double serial_share(double single_ms, double threads_ms, int threads) {
  if (threads < 2 || !(single_ms > 0)) return 0;
  const double p = threads;
  return (threads_ms / single_ms - 1 / p) / (1 - 1 / p);
}

double moved_bytes_per_particle(float alpha, double average_neighbors) {
  double bytes = 0;
  for (const Moved& phase : k_moved) {
    if ((phase.sph && !(alpha > 0)) || (phase.shape && !(alpha < 1))) continue;
    bytes += phase.per_particle + phase.per_neighbor * average_neighbors;
  }
  return bytes;
}

double memory_rate(int threads) {
  Column<float> a(k_rate_floats), b(k_rate_floats), c(k_rate_floats);
  std::vector<double> ms;
  for (int pass = 0; pass < k_rate_passes; ++pass) {
    ms.push_back(milliseconds([&] {
      parallel_for(
          threads, k_rate_floats,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) a[i] = b[i] + c[i];
          },
          k_rate_floats / 64);
    }));
  }
  return 3.0 * k_rate_floats * sizeof(float) / (minimum(ms) / 1000);
}

Json extrapolate(const Measurement& single, const Measurement& several, const MemoryRates& rates) {
  const double share = serial_share(single.smallest_ms(), several.smallest_ms(), several.threads);
  const double amdahl_share = std::clamp(share, 0.0, 1.0);
  const double moved =
      moved_bytes_per_particle(cube_alpha(single.cube.material), average_neighbors(single.cube));
  const double bytes = moved * static_cast<double>(single.cube.particles());
  Json rows = Json::array();
  for (const int cores : k_cores) {
    const double amdahl = single.smallest_ms() * (amdahl_share + (1 - amdahl_share) / cores);
    const double same_memory = 1000 * bytes / rates.all_threads;
    const double more_memory = 1000 * bytes / (rates.one_thread * cores);
    rows.push_back({{"material", single.cube.material},
                    {"particles", single.cube.particles()},
                    {"cores", cores},
                    {"measured_ms_one_thread", single.smallest_ms()},
                    {"measured_serial_share", share},
                    {"moved_bytes_per_particle", moved},
                    {"amdahl_ms", amdahl},
                    {"amdahl_speedup", single.smallest_ms() / amdahl},
                    {"memory_ms_at_this_machines_rate", same_memory},
                    {"memory_ms_at_one_threads_rate_per_core", more_memory},
                    {"ms_at_this_machines_rate", std::max(amdahl, same_memory)},
                    {"ms_at_one_threads_rate_per_core", std::max(amdahl, more_memory)}});
  }
  return rows;
}

}  // namespace mallow::bench

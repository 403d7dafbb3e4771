#include "scaling/memory.h"

#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "config/field_tables.h"
#include "mallow/errors.h"
#include "program/machine.h"
#include "scaling/cube.h"

namespace mallow::bench {
namespace {

/// Particles of the run that memory is foretold from: few enough to take no time, enough that the surface,
/// where particles have fewer neighbours, is a small part.
constexpr std::size_t k_trial_particles = 32768;
/// Lists that grow keep the old ones until the new ones are there, and the allocator rounds up.
constexpr double k_margin = 1.2;
/// Positions and velocities of a body, and the velocities that the simulation makes of them [bytes a
/// particle].
constexpr double k_body_bytes = 36;
/// What counts the neighbours of a group that keeps none, for the report: a grid and lists [bytes a
/// particle].
constexpr double k_count_bytes = 210;

std::string gibibytes(double bytes) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f GiB", bytes / (1 << 30));
  return text;
}

}  // namespace

PeakMemory::PeakMemory() {
  // What earlier runs freed is given back, so that it is not taken for memory that is held.
  ::malloc_trim(0);
  std::ofstream clear("/proc/self/clear_refs");
  counted_ = static_cast<bool>(clear << "5" << std::flush);  // 5: the peak starts anew, proc(5)
  before_ = program::proc_bytes("/proc/self/status", "VmRSS");
}

std::optional<std::size_t> PeakMemory::bytes() const {
  const std::size_t peak = program::proc_bytes("/proc/self/status", "VmHWM");
  if (!counted_ || before_ == 0 || peak < before_) return {};
  return peak - before_;
}

double needed_bytes_per_particle(const std::vector<std::string>& materials, int threads) {
  double most = 0;
  for (const std::string& material : materials) {
    const Cube cube = make_cube(material, k_trial_particles);
    Simulation simulation = build(cube, threads);
    simulation.step();
    const SimulationInfo info = simulation.info();
    const double bytes = static_cast<double>(info.bytes) / static_cast<double>(cube.particles());
    most = std::max(
        most, k_margin * bytes + k_body_bytes + (info.bodies.front().shape_matching ? 0.0 : k_count_bytes));
  }
  return most;
}

void check_memory(const std::vector<std::size_t>& sizes, double bytes_per_particle, std::size_t available) {
  const double needed = bytes_per_particle * static_cast<double>(sizes.back());
  if (available > 0 && needed > static_cast<double>(available)) {
    const auto fits = static_cast<std::size_t>(static_cast<double>(available) / bytes_per_particle);
    throw ConfigError("--max-particles",
                      std::to_string(sizes.back()) + " particles need " + gibibytes(needed) +
                          " of memory and " + gibibytes(static_cast<double>(available)) +
                          " are available: --max-particles " + std::to_string(fits) + " fits");
  }
  if (sizes.back() > static_cast<std::size_t>(k_most_particles))
    throw ConfigError("--max-particles", std::to_string(sizes.back()) + " is not allowed: at most " +
                                             std::to_string(k_most_particles));
}

}  // namespace mallow::bench

#include "scaling/measurement.h"

#include "harness/statistics.h"
#include "program/failure.h"
#include "program/run_report.h"
#include "scaling/memory.h"
#include "scaling/on_paper.h"

namespace mallow::bench {
namespace {

/// Phases shorter than this share of a step say nothing of how they scale.
constexpr double k_least_share = 0.01;

template <class Value>
std::vector<double> of_runs(const Measurement& measurement, const Value& value) {
  std::vector<double> values;
  for (const CubeRun& run : measurement.runs) values.push_back(value(run));
  return values;
}

Json least_and_middle(const std::vector<double>& values, double factor = 1) {
  return {{"min", factor * minimum(values)}, {"median", factor * median(values)}};
}

std::vector<double> phase_ms(const Measurement& measurement, std::size_t phase) {
  return of_runs(measurement, [&](const CubeRun& run) { return run.phase_ms[phase]; });
}

double ms_per_particle(const Measurement& measurement) {
  return measurement.smallest_ms() / static_cast<double>(measurement.cube.particles());
}

std::string box_text(const Cube& cube) {
  return std::to_string(cube.count[0]) + "x" + std::to_string(cube.count[1]) + "x" +
         std::to_string(cube.count[2]);
}

Json memory_json(const Measurement& measurement) {
  const auto n = static_cast<double>(measurement.cube.particles());
  std::vector<double> peaks;
  for (const CubeRun& run : measurement.runs)
    if (run.peak_bytes) peaks.push_back(static_cast<double>(*run.peak_bytes) / n);
  return {{"held", static_cast<double>(measurement.runs.front().bytes) / n},
          {"peak", peaks.empty() ? Json() : Json(median(peaks))}};
}

/// How the time with several threads compares with that of one.
void add_scaling(const Measurement& m, const Measurement& single, const Measurement* half, Json& row) {
  const double speedup = single.smallest_ms() / m.smallest_ms();
  row["speedup"] = speedup;
  row["efficiency"] = speedup / m.threads;
  // Per particle, because boxes double to within a percent or two only.
  row["weak_efficiency"] = half ? Json(ms_per_particle(*half) / (m.threads * ms_per_particle(m))) : Json();
  row["serial_share"] = serial_share(single.smallest_ms(), m.smallest_ms(), m.threads);
  Json phases = Json::object();
  for (std::size_t p = 0; p < k_phase_count; ++p) {
    const auto phase = static_cast<Phase>(p);
    const double alone = single.smallest_phase_ms(phase);
    if (alone < k_least_share * single.smallest_ms()) continue;
    phases[name(phase)] = serial_share(alone, m.smallest_phase_ms(phase), m.threads);
  }
  row["phase_serial_share"] = std::move(phases);
}

}  // namespace

CubeRun run_cube(const Cube& cube, int threads, int steps) {
  CubeRun run;
  const PeakMemory peak;
  Simulation simulation = build(cube, threads);
  run.prepare_ms = milliseconds([&] { simulation.prepare(); });
  settle(cube, simulation);
  simulation.step();
  const double count = steps;
  for (int step = 0; step < steps; ++step) {
    StepReport report;
    run.ms_per_step += milliseconds([&] { report = simulation.step(); }) / count;
    for (std::size_t p = 0; p < k_phase_count; ++p) run.phase_ms[p] += 1000 * report.seconds[p] / count;
  }
  run.peak_bytes = peak.bytes();
  run.bytes = simulation.info().bytes;
  run.state_hash = program::hash_text(simulation.state_hash());
  return run;
}

double Measurement::smallest_ms() const {
  return minimum(of_runs(*this, [](const CubeRun& run) { return run.ms_per_step; }));
}

double Measurement::smallest_phase_ms(Phase phase) const {
  return minimum(phase_ms(*this, static_cast<std::size_t>(phase)));
}

std::vector<Measurement> measure(const Cube& cube, const std::vector<int>& threads, int steps, int repeats) {
  std::vector<Measurement> measurements;
  for (const int count : threads) measurements.push_back({cube, count, steps});
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (Measurement& m : measurements) m.runs.push_back(run_cube(cube, m.threads, steps));
  const std::string& expected = measurements.front().runs.front().state_hash;
  for (const Measurement& m : measurements)
    for (const CubeRun& run : m.runs)
      if (run.state_hash != expected)
        throw program::RunFailure(cube.material + " cube of " + std::to_string(cube.particles()) +
                                  " particles: " + std::to_string(m.threads) + " threads end in state " +
                                  run.state_hash + ", the first run with " + std::to_string(threads.front()) +
                                  " in " + expected);
  return measurements;
}

Json measurement_row(const Measurement& m, const Measurement& single, const Measurement* half) {
  const auto n = static_cast<double>(m.cube.particles());
  const std::vector<double> steps = of_runs(m, [](const CubeRun& run) { return run.ms_per_step; });
  Json phases = Json::object();
  for (std::size_t p = 0; p < k_phase_count; ++p)
    phases[name(static_cast<Phase>(p))] = least_and_middle(phase_ms(m, p));
  Json row = {{"scene", "cube"},
              {"material", m.cube.material},
              {"alpha", cube_alpha(m.cube.material)},
              {"particles", m.cube.particles()},
              {"bodies", m.cube.bodies},
              {"between", m.cube.bodies > 1 ? m.cube.between : std::string()},
              {"box", box_text(m.cube)},
              {"support_radius", k_cube_radius},
              {"average_neighbors", average_neighbors(m.cube)},
              {"threads", m.threads},
              {"steps", m.steps},
              {"repeats", m.runs.size()},
              {"ms_per_step", least_and_middle(steps)},
              {"ns_per_particle", least_and_middle(steps, 1e6 / n)},
              {"phase_ms", std::move(phases)},
              {"contact_share", m.smallest_phase_ms(Phase::body_contact) / m.smallest_ms()},
              {"prepare_ms", least_and_middle(of_runs(m, [](const CubeRun& run) { return run.prepare_ms; }))},
              {"bytes_per_particle", memory_json(m)},
              {"speedup", nullptr},
              {"efficiency", nullptr},
              {"weak_efficiency", nullptr},
              {"serial_share", nullptr},
              {"phase_serial_share", Json::object()},
              {"state_hash", m.runs.front().state_hash}};
  if (m.threads > 1) add_scaling(m, single, half, row);
  return row;
}

}  // namespace mallow::bench

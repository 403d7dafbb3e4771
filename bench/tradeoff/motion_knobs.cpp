#include "tradeoff/motion_knobs.h"

#include <cmath>

#include "harness/statistics.h"
#include "mallow/tuning.h"
#include "program/run_report.h"
#include "tradeoff/errors.h"

namespace mallow::bench {
namespace {

constexpr int k_steps_per_moment = 4;
/// Simulated time of the free flight [s].
constexpr double k_flight = 15;

const Lattice& lattice(const Scene& scene) {
  return std::get<Lattice>(scene.bodies.front().source);
}

double spacing(const Scene& scene) {
  return static_cast<double>(lattice(scene).spacing);
}

}  // namespace

Json to_json(const TradeoffSettings& settings) {
  return {{"repeats", settings.repeats},
          {"reference_factor", settings.reference_factor},
          {"duration", settings.duration},
          {"small", settings.small}};
}

double moment_interval(const Scene& scene) {
  return k_steps_per_moment * static_cast<double>(scene.solver.time_step.value());
}

std::size_t moment_count(const Scene& scene, const TradeoffSettings& settings) {
  return 1 + static_cast<std::size_t>(std::lround(settings.duration / moment_interval(scene)));
}

Reference make_reference(const Scene& scene, const TradeoffSettings& settings, int threads) {
  const double interval = moment_interval(scene);
  const std::size_t count = moment_count(scene, settings);
  const auto run = [&](int factor) {
    return run_textbook(at_time_step(scene, 1.0f / static_cast<float>(factor)), interval, count, threads);
  };
  Reference reference{run(settings.reference_factor), {}};
  for (int factor = 1; factor < settings.reference_factor; factor *= 2) {
    const Trajectory coarser = run(factor);
    reference.convergence.push_back(
        {{"time_step", static_cast<double>(scene.solver.time_step.value()) / factor},
         {"reference_time_step",
          static_cast<double>(scene.solver.time_step.value()) / settings.reference_factor},
         {"errors", to_json(compare(coarser, reference.motion, scene.solver.gravity, spacing(scene),
                                    spacing(scene)))}});
  }
  return reference;
}

std::vector<Json> measure_motion(const std::string& scene_name, const std::filesystem::path& file,
                                 const std::vector<Setting>& all, const Reference& reference,
                                 const TradeoffSettings& settings, int threads,
                                 const std::function<void()>& checkpoint) {
  const Scene written = read_scene_at(file, all.front());
  const double interval = moment_interval(written);
  const std::size_t count = moment_count(written, settings);
  std::vector<Json> rows;
  std::vector<Scene> scenes;
  for (const Setting& setting : all) {
    checkpoint();
    scenes.push_back(read_scene_at(file, setting));
    const Scene& scene = scenes.back();
    const Trajectory motion = run_engine(scene, interval, count, threads);
    Json row = {{"scene", scene_name},
                {"part", "motion"},
                {"knobs", setting.knobs},
                {"setting", setting.label},
                {"overrides", setting.overrides},
                {"time_step", scene.solver.time_step_factor * scene.solver.time_step.value()},
                {"particles", motion.moments.front().x.rows()},
                {"failure", motion.failure},
                {"on_front", false},
                {"state_hash", program::hash_text(motion.state_hash)}};
    if (motion.complete(count)) {
      const Trajectory& same = reference.motion;
      const bool resample = lattice(scene).count != lattice(written).count;
      row["errors"] =
          to_json(compare(motion, resample ? resampled(same, lattice(written), lattice(scene)) : same,
                          written.solver.gravity, spacing(scene), spacing(written)));
      const Drift drift = free_flight_drift(scene, std::min(k_flight, settings.duration), threads);
      row["momentum_drift"] = drift.momentum;
      row["angular_momentum_drift"] = drift.angular_momentum;
    }
    rows.push_back(std::move(row));
  }

  // Round by round, so that a slow minute of the machine meets all settings alike.
  std::vector<std::vector<double>> ms(all.size());
  for (int repeat = 0; repeat < settings.repeats; ++repeat) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      checkpoint();
      if (rows[i]["failure"].get<std::string>().empty())
        ms[i].push_back(milliseconds_per_second(scenes[i], settings.duration, threads));
    }
  }
  std::vector<Trade> choices;
  for (std::size_t i = 0; i < all.size(); ++i) {
    choices.push_back({NAN, NAN});
    if (!rows[i].contains("errors")) continue;
    rows[i]["ms_per_second"] = median(ms[i]);
    rows[i]["ms_per_second_min"] = minimum(ms[i]);
    rows[i]["speed"] = minimum(ms[0]) / minimum(ms[i]);
    // The minimum: whatever else the machine does only adds.
    choices.back() = {minimum(ms[i]), rows[i]["errors"]["position_h"]};
  }
  for (const std::size_t i : pareto_front(choices)) rows[i]["on_front"] = true;
  return rows;
}

}  // namespace mallow::bench

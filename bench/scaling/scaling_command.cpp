#include "scaling/scaling_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "harness/command.h"
#include "harness/plot.h"
#include "mallow/errors.h"
#include "program/machine.h"
#include "scaling/cube.h"
#include "scaling/measurement.h"
#include "scaling/memory.h"
#include "scaling/on_paper.h"

namespace mallow::bench {
namespace {

/// Particles times steps that all repeats of a cube take, about, and bounds of the repeats: small cubes need
/// many for a quiet moment, large ones take long.
constexpr double k_particle_steps = 6e6;
constexpr double k_least_repeats = 2, k_most_repeats = 30;

struct ScalingOptions : CommonOptions {
  std::size_t max_particles = 4'194'304;
  std::size_t min_particles = 1000;
  std::vector<std::string> materials = {"paste"};
  int steps = 5;
  int repeats = 0;  ///< 0: by size
  std::size_t bodies = 1;
  std::string between = "apart";
};

int repeats_of(std::size_t particles, const ScalingOptions& options) {
  if (options.repeats > 0) return options.repeats;
  const double repeats = k_particle_steps / (static_cast<double>(particles) * options.steps);
  return static_cast<int>(std::clamp(std::round(repeats), k_least_repeats, k_most_repeats));
}

/// 1, 2, 4, ... and `most`.
std::vector<int> thread_counts(int most) {
  std::vector<int> counts;
  for (int count = 1; count < most; count *= 2) counts.push_back(count);
  counts.push_back(most);
  return counts;
}

Json settings(const ScalingOptions& options) {
  return {{"materials", options.materials},
          {"min_particles", options.min_particles},
          {"max_particles", options.max_particles},
          {"steps", options.steps},
          {"repeats", options.repeats},
          {"bodies", options.bodies},
          {"support_radius", k_cube_radius},
          {"spacing", 1.0}};
}

/// The single thread's run with `particles` as they were asked for, among those measured so far.
const Measurement* with_one_thread(const std::vector<std::pair<std::size_t, Measurement>>& singles,
                                   std::size_t particles) {
  for (const auto& [asked, measurement] : singles)
    if (asked == particles) return &measurement;
  return nullptr;
}

void report_progress(const Json& row) {
  std::fprintf(stderr, "scaling: %s, %s particles, %s threads: %.3f ms a step, %.1f ns a particle\n",
               row["material"].get<std::string>().c_str(), row["particles"].dump().c_str(),
               row["threads"].dump().c_str(), row["ms_per_step"]["min"].get<double>(),
               row["ns_per_particle"]["min"].get<double>());
}

/// All sizes of one material. Gives the measurements of the largest, one per number of threads.
std::vector<Measurement> measure_material(const std::string& material, const ScalingOptions& options,
                                          const std::vector<std::size_t>& sizes, Results& results) {
  std::vector<std::pair<std::size_t, Measurement>> singles;
  std::vector<Measurement> measured;
  for (const std::size_t size : sizes) {
    const Cube cube = make_cube(material, size, options.bodies, options.between);
    measured = measure(cube, thread_counts(options.threads), options.steps, repeats_of(size, options));
    singles.emplace_back(size, measured.front());
    for (const Measurement& m : measured) {
      const auto threads = static_cast<std::size_t>(m.threads);
      const Measurement* part = size % threads == 0 ? with_one_thread(singles, size / threads) : nullptr;
      results.add(measurement_row(m, measured.front(), part));
      report_progress(results.rows().back());
    }
    stop_if_interrupted(results);
  }
  return measured;
}

using RowValue = std::function<Json(const Json& row)>;

/// A curve over the particles for every material and number of threads.
std::vector<Series> curves(const Json& rows, const std::string& what, const RowValue& value) {
  std::vector<Series> series;
  for (const Json& row : rows) {
    const Json y = value(row);
    if (!y.is_number()) continue;
    const std::string title = what + row["material"].get<std::string>() + ", " + row["threads"].dump() +
                              (row["threads"] == 1 ? " thread" : " threads");
    auto curve =
        std::find_if(series.begin(), series.end(), [&](const Series& s) { return s.title == title; });
    if (curve == series.end()) curve = series.insert(series.end(), Series{title, {}});
    curve->points.emplace_back(row["particles"].get<double>(), y.get<double>());
  }
  return series;
}

void draw(const Results& results) {
  const Json& rows = results.rows();
  write_svg(results.file("_time.svg"),
            Plot{.title = "Time per particle and step",
                 .x_label = "particles",
                 .y_label = "ns",
                 .log_x = true,
                 .series = curves(rows, "", [](const Json& row) { return row["ns_per_particle"]["min"]; })});
  std::vector<Series> efficiency =
      curves(rows, "strong: ", [](const Json& row) { return row["efficiency"]; });
  for (Series& series : curves(rows, "weak: ", [](const Json& row) { return row["weak_efficiency"]; }))
    efficiency.push_back(std::move(series));
  write_svg(results.file("_efficiency.svg"), Plot{.title = "Efficiency against one thread",
                                                  .x_label = "particles",
                                                  .y_label = "efficiency",
                                                  .log_x = true,
                                                  .series = std::move(efficiency)});
}

void print_tables(const Results& results, const MemoryRates& rates, const Json& extrapolation) {
  const Json& rows = results.rows();
  std::vector<TableColumn> head = {{"material", "material"},
                                   {"particles", "particles"},
                                   {"bodies", "bodies"},
                                   {"between", "between"},
                                   {"threads", "threads"}};
  std::vector<TableColumn> times = head, phases = head, shares = head;
  times.insert(times.end(), {{"ms_per_step.min", "ms/step", 3},
                             {"ms_per_step.median", "median", 3},
                             {"ns_per_particle.min", "ns/particle", 1},
                             {"speedup", "speedup"},
                             {"efficiency", "efficiency"},
                             {"weak_efficiency", "weak"},
                             {"serial_share", "serial share", 3},
                             {"prepare_ms.min", "prepare ms", 1},
                             {"bytes_per_particle.held", "bytes/particle", 0},
                             {"bytes_per_particle.peak", "peak", 0},
                             {"state_hash", "state"}});
  for (std::size_t p = 0; p < k_phase_count; ++p) {
    const std::string phase = name(static_cast<Phase>(p));
    phases.push_back({"phase_ms." + phase + ".min", phase, 3});
    shares.push_back({"phase_serial_share." + phase, phase});
  }
  Json of_several = Json::array();
  for (const Json& row : rows)
    if (row["threads"] != 1) of_several.push_back(row);
  std::printf("%s\nms per step and phase\n\n%s", markdown_table(rows, times).c_str(),
              markdown_table(rows, phases).c_str());
  std::printf("\nmemory: %.1f GB/s on one thread, %.1f GB/s on all\n", rates.one_thread / 1e9,
              rates.all_threads / 1e9);
  if (of_several.empty()) return;
  std::printf("\nshare of a phase that does not scale (0: all of it does, 1: none)\n\n%s",
              markdown_table(of_several, shares).c_str());
  std::printf(
      "\non paper, not measured: more cores\n\n%s",
      markdown_table(extrapolation, {{"material", "material"},
                                     {"particles", "particles"},
                                     {"cores", "cores"},
                                     {"amdahl_ms", "Amdahl ms"},
                                     {"amdahl_speedup", "speedup"},
                                     {"memory_ms_at_this_machines_rate", "memory ms, this rate"},
                                     {"memory_ms_at_one_threads_rate_per_core", "memory ms, rate x cores"},
                                     {"ms_at_this_machines_rate", "slower of both"},
                                     {"ms_at_one_threads_rate_per_core", "rate x cores"}})
          .c_str());
}

void set_extrapolation(const Json& rows, Results& results) {
  results.set(
      "extrapolation",
      {{"measured", false},
       {"assumes",
        "Amdahl's law with the serial share of this machine's threads at the largest size; and that memory "
        "moves every column and list of every phase at least once, at this machine's rate, or at one "
        "thread's rate times the cores"},
       {"rows", rows}});
}

void run_scaling(const ScalingOptions& options) {
  const std::vector<std::string> materials = chosen("--material", options.materials, cube_materials());
  const std::vector<std::size_t> sizes = cube_sizes(options.min_particles, options.max_particles);
  if (sizes.empty())
    throw ConfigError("--max-particles", std::to_string(options.max_particles) +
                                             " is not allowed: at least --min-particles, " +
                                             std::to_string(options.min_particles));
  check_memory(sizes, needed_bytes_per_particle(materials, options.threads), program::available_memory());

  Results results("scaling", options.output, options.threads, settings(options));
  const MemoryRates rates{memory_rate(1), memory_rate(options.threads)};
  results.set("memory_rate", {{"one_thread_bytes_per_second", rates.one_thread},
                              {"all_threads_bytes_per_second", rates.all_threads}});
  Json extrapolation = Json::array();
  set_extrapolation(extrapolation, results);
  for (const std::string& material : materials) {
    const std::vector<Measurement> largest = measure_material(material, options, sizes, results);
    if (options.threads < 2) continue;
    for (Json& row : extrapolate(largest.front(), largest.back(), rates))
      extrapolation.push_back(std::move(row));
    set_extrapolation(extrapolation, results);
  }
  results.close();
  draw(results);
  print_tables(results, rates, extrapolation);
}

}  // namespace

void add_scaling_command(CLI::App& app) {
  const auto options = std::make_shared<ScalingOptions>();
  CLI::App* command = add_command(
      app, "scaling", "Cubes of many sizes on one thread and on several: time, memory, what is serial",
      *options, [options] { run_scaling(*options); });
  command->add_option("--max-particles", options->max_particles, "Particles of the largest cube, at the most")
      ->check(CLI::Range(std::size_t{8}, std::size_t{1} << 50))
      ->capture_default_str();
  command
      ->add_option("--min-particles", options->min_particles, "Particles of the smallest cube; sizes double")
      ->check(CLI::Range(std::size_t{8}, std::size_t{1} << 50))
      ->capture_default_str();
  command
      ->add_option("--material", options->materials,
                   "elastic (no SPH), paste, fluid (no shape matching); several are allowed")
      ->capture_default_str();
  command
      ->add_option("--steps", options->steps,
                   "Steps that are timed, after one that is not; the same for every size, as bodies deform")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--bodies", options->bodies, "Bodies that share the particles of each size")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 32))
      ->capture_default_str();
  command
      ->add_option("--between", options->between,
                   "Of several bodies: apart (none is near another), touching (face to face), merging (one "
                   "by their particles)")
      ->check(CLI::IsMember({"apart", "touching", "merging"}))
      ->capture_default_str();
  command->add_option("--repeats", options->repeats, "Runs of each cube and number of threads; 0: by size")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
}

}  // namespace mallow::bench

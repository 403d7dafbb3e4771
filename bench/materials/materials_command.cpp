#include "materials/materials_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "bars/bar.h"
#include "harness/command.h"
#include "mallow/errors.h"
#include "mallow/materials.h"
#include "materials/numbers.h"
#include "materials/standard_tests.h"

namespace mallow::bench {
namespace {

constexpr const char* k_bars = "bars";  // among the names of materials
constexpr std::pair<const char*, void (*)(int, const AddNumber&)> k_numbers[] = {
    {"volume", measure_volume},
    {"yield", measure_yield},
    {"cost", measure_cost},
    {"heat", measure_heat},
    {"realtime", measure_realtime}};
const std::vector<std::string> k_scenes{"drop", "squeeze", "slope"};
constexpr double k_refined[] = {1, 1.5, 2};
constexpr double k_steps[] = {0.25, 0.5, 1, 2};

struct MaterialsOptions : CommonOptions {
  std::vector<std::string> materials;
  std::vector<std::string> scenes;
  bool coarse = false;
};

Json row(const std::string& test, const std::string& material, double spacing, double time_step,
         const Measured& measured) {
  Json json{{"test", test},           {"material", material},          {"spacing", spacing},
            {"time_step", time_step}, {"quantity", measured.quantity}, {"value", measured.value}};
  if (measured.theory) {
    json["theory"] = *measured.theory;
    json["ratio"] = measured.value / *measured.theory;
  }
  return json;
}

/// The same bar at three spacings, and the coarsest at four steps.
std::vector<bars::Bar> bars_of(double alpha) {
  std::vector<bars::Bar> list;
  for (const double by : k_refined)
    for (const double step : k_steps) {
      if (by > 1 && step != 1) continue;
      bars::Bar bar{.alpha = alpha};
      bar.spacing /= by;
      bar.across = static_cast<int>(std::lround(bar.across * by));
      bar.along = static_cast<int>(std::lround(bar.along * by));
      bar.time_step *= step / by;
      list.push_back(bar);
    }
  return list;
}

void measure_bars(Results& results, int threads) {
  for (const double alpha : {0.0, 0.3})
    for (bars::Bar bar : bars_of(alpha)) {
      bar.threads = threads;
      std::fprintf(stderr, "materials: bars, alpha %g, spacing %g\n", alpha, bar.spacing);
      const std::string name = "alpha " + std::to_string(alpha).substr(0, 3);
      const auto add = [&](const char* test, const bars::Swing& got, const bars::Swing& theory) {
        if (theory.rest > 0)
          results.add(row(test, name, bar.spacing, bar.time_step, {"rest [m]", got.rest, theory.rest}));
        results.add(row(test, name, bar.spacing, bar.time_step, {"period [s]", got.period, theory.period}));
      };
      add("bend", bars::bend(bar), bars::theory_of_bend(bar));
      add("stretch", bars::stretch(bar), bars::theory_of_stretch(bar));
      add("twist", bars::twist(bar), bars::theory_of_twist(bar));
      stop_if_interrupted(results);
    }
}

void measure_material(const std::string& material, const MaterialsOptions& options, Results& results) {
  for (const std::string& scene : chosen("--scenes", options.scenes, k_scenes))
    for (const int refined : {1, 2}) {
      if (refined > 1 && options.coarse) continue;
      std::fprintf(stderr, "materials: %s, %s, refined %d times\n", material.c_str(), scene.c_str(), refined);
      const TestRun done =
          run({.scene = scene, .material = material, .refined = refined, .threads = options.threads});
      for (const Measured& measured : done.measured) {
        Json json = row(scene, material, done.spacing, done.time_step, measured);
        json["seconds"] = done.seconds;
        results.add(std::move(json));
      }
      stop_if_interrupted(results);
    }
}

void run_materials(const MaterialsOptions& options) {
  std::vector<std::string> known{k_bars};
  for (const auto& [name, measure] : k_numbers) known.emplace_back(name);
  for (const MaterialPreset& preset : material_presets()) known.emplace_back(preset.name);
  const std::vector<std::string> names = chosen("--materials", options.materials, known);
  Results results("materials", options.output, options.threads,
                  {{"materials", options.materials}, {"scenes", options.scenes}, {"coarse", options.coarse}});
  for (const std::string& name : names) {
    const auto* const numbers = std::ranges::find(k_numbers, name, [](const auto& one) { return one.first; });
    if (name == k_bars)
      measure_bars(results, options.threads);
    else if (numbers != std::end(k_numbers))
      numbers->second(options.threads,
                      [&](const char* test, const std::string& setting, const Measured& measured) {
                        results.add(row(test, setting, 1, 0.15, measured));
                        stop_if_interrupted(results);
                      });
    else
      measure_material(name, options, results);
  }
  results.close();
  std::printf("%s", markdown_table(results.rows(), {{"test", "test"},
                                                    {"material", "material"},
                                                    {"spacing", "h [m]", 5},
                                                    {"time_step", "step [s]", 6},
                                                    {"quantity", "quantity"},
                                                    {"value", "measured", 4},
                                                    {"theory", "theory", 4},
                                                    {"ratio", "ratio", 3}})
                        .c_str());
}

}  // namespace

void add_materials_command(CLI::App& app) {
  const auto options = std::make_shared<MaterialsOptions>();
  CLI::App* command = add_command(app, "materials", "What materials do beside what their numbers say",
                                  *options, [options] { run_materials(*options); });
  command
      ->add_option("--materials", options->materials,
                   "Some of them, or bars, volume, yield, cost, heat, realtime, in place of all")
      ->delimiter(',');
  command->add_option("--scenes", options->scenes, "Of drop, squeeze, slope, in place of all")
      ->delimiter(',');
  command->add_flag("--coarse", options->coarse, "At one spacing only");
}

}  // namespace mallow::bench

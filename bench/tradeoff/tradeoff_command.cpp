#include "tradeoff/tradeoff_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "harness/command.h"
#include "harness/plot.h"
#include "tradeoff/knobs.h"
#include "tradeoff/motion_knobs.h"
#include "tradeoff/surface_knobs.h"

namespace mallow::bench {
namespace {

const std::vector<std::string> k_scenes = {"elastic", "jelly", "paste", "fluid"};
/// In settings for tests: particles along a side, and how long they move [s].
constexpr int k_small_side = 6;
constexpr double k_small_duration = 9;

struct TradeoffOptions {
  CommonOptions common;
  std::vector<std::string> scenes, knobs;
  TradeoffSettings settings;
};

std::filesystem::path scene_file(const std::string& name) {
  return data_file("scenes/tradeoff/" + name + ".toml");
}

/// Every setting of the scene in fewer particles.
std::vector<Setting> made_small(std::vector<Setting> settings, const Setting& fewer) {
  for (Setting& setting : settings)
    setting.overrides.insert(setting.overrides.begin(), fewer.overrides.begin(), fewer.overrides.end());
  return settings;
}

Plot front_plot(const std::string& scene, const Json& rows, const std::string& part, const std::string& cost,
                const std::string& error) {
  Plot plot{
      .title = scene + ": speed against accuracy, " + part,
      .x_label = part == "motion" ? "cost [ms per simulated second]" : "cost [ms]",
      .y_label = part == "motion" ? "RMS position error [h]" : "mean distance to the finest surface [h]",
      .log_x = true,
      .log_y = true,
      .series = {{.title = "front", .points = {}}, {.title = "settings", .points = {}, .lines = false}},
      .width = 2000,
      .height = 1300};
  std::vector<std::tuple<double, double, std::string>> front;
  for (const Json& row : rows) {
    if (row["scene"] != scene || row["part"] != part || !row.contains(cost)) continue;
    const double x = row[cost], y = row[nlohmann::ordered_json::json_pointer(error)];
    if (row["on_front"]) {
      front.emplace_back(x, y, row["setting"]);
    } else {
      plot.series[1].points.emplace_back(x, y);
      plot.series[1].labels.push_back(row["setting"]);
    }
  }
  std::sort(front.begin(), front.end());
  for (const auto& [x, y, label] : front) {
    plot.series[0].points.emplace_back(x, y);
    plot.series[0].labels.push_back(label);
  }
  return plot;
}

Json on_front(const Json& rows, const std::string& part) {
  Json front = Json::array();
  for (const Json& row : rows)
    if (row["part"] == part && (row["on_front"] || row["setting"] == "as written")) front.push_back(row);
  std::stable_sort(front.begin(), front.end(), [&](const Json& a, const Json& b) {
    const auto place = [](const Json& row) {
      return std::ranges::find(k_scenes, row["scene"].get<std::string>()) - k_scenes.begin();
    };
    const char* cost = part == "motion" ? "ms_per_second_min" : "ms_min";
    return place(a) != place(b) ? place(a) < place(b) : a[cost].get<double>() < b[cost].get<double>();
  });
  return front;
}

void run(const TradeoffOptions& options) {
  const std::vector<std::string> scenes = chosen("--scenes", options.scenes, k_scenes);
  const std::vector<std::string> knobs = chosen("--knobs", options.knobs, knob_names());
  TradeoffSettings settings = options.settings;
  if (settings.small) settings.duration = std::min(settings.duration, k_small_duration);
  const int threads = options.common.threads;
  for (const std::string& name : scenes) read_scene(scene_file(name));

  Results results("tradeoff", options.common.output, threads, to_json(settings));
  const auto checkpoint = [&] { stop_if_interrupted(results); };
  Json references;
  for (const std::string& name : scenes) {
    std::fprintf(stderr, "tradeoff: %s, reference\n", name.c_str());
    Setting written{.knobs = "as written", .label = "as written"};
    if (settings.small)
      written.overrides = fewer_particles(read_scene(scene_file(name)), k_small_side).overrides;
    const Scene scene = read_scene_at(scene_file(name), written);
    const Reference reference = make_reference(scene, settings, threads);
    references[name] = reference.convergence;
    results.set("references", references);

    std::fprintf(stderr, "tradeoff: %s, settings\n", name.c_str());
    const std::vector<Setting> all = made_small(make_settings(scene, knobs, settings.small), written);
    for (Json& row : measure_motion(name, scene_file(name), all, reference, settings, threads, checkpoint))
      results.add(std::move(row));
    for (Json& row : measure_surfaces(
             name, scene, run_engine(scene, moment_interval(scene), moment_count(scene, settings), threads),
             settings.repeats, settings.small, threads))
      results.add(std::move(row));
    write_svg(results.file("_" + name + ".svg"),
              front_plot(name, results.rows(), "motion", "ms_per_second_min", "/errors/position_h"));
    write_svg(results.file("_" + name + "_surface.svg"),
              front_plot(name, results.rows(), "surface", "ms_min", "/mean_distance_h"));
  }
  results.close();

  std::puts("Settings on the front of each scene, and the scene as written:\n");
  std::fputs(markdown_table(on_front(results.rows(), "motion"), {{"scene", "scene"},
                                                                 {"setting", "setting"},
                                                                 {"ms_per_second_min", "ms per s"},
                                                                 {"speed", "speed"},
                                                                 {"errors.position_h", "position [h]", 3},
                                                                 {"errors.height_h", "height [h]", 3},
                                                                 {"errors.spread_h", "spread [h]", 3},
                                                                 {"errors.density", "density", 4},
                                                                 {"errors.momentum", "momentum", 4},
                                                                 {"errors.energy", "energy", 4}})
                 .c_str(),
             stdout);
  std::puts("\nSurfaces:\n");
  std::fputs(markdown_table(on_front(results.rows(), "surface"), {{"scene", "scene"},
                                                                  {"setting", "setting"},
                                                                  {"ms_min", "ms"},
                                                                  {"mean_distance_h", "mean [h]", 4},
                                                                  {"hausdorff_h", "Hausdorff [h]", 3},
                                                                  {"triangles", "triangles", 0}})
                 .c_str(),
             stdout);
}

}  // namespace

void add_tradeoff_command(CLI::App& app) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App* command =
      add_command(app, "tradeoff", "What every knob costs and buys: errors against a converged reference",
                  options->common, [options] { run(*options); });
  command->add_option("--scenes", options->scenes, "Scenes to run, by name; all where left out")
      ->delimiter(',');
  command->add_option("--knobs", options->knobs, "Knobs to turn, by name; all where left out")
      ->delimiter(',');
  command->add_option("--repeats", options->settings.repeats, "Timed runs of every setting")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--reference-factor", options->settings.reference_factor,
                   "The reference's steps are this much shorter than the scene's")
      ->check(CLI::Range(2, 1024))
      ->capture_default_str();
  command->add_option("--duration", options->settings.duration, "Simulated time of every run [s]")
      ->check(CLI::Range(0.6, 1000.0))
      ->capture_default_str();
  command->add_flag("--small", options->settings.small, "Few particles and settings, to see that it works");
}

}  // namespace mallow::bench

#include "program/cached_run.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "mallow/errors.h"
#include "program/input_files.h"
#include "program/machine.h"
#include "program/shared_frames.h"

namespace mallow::program {
namespace {

/// In report.json, where `mallow surface` drew surfaces anew.
constexpr const char* k_surface_as_run = "surface_as_run";
constexpr const char* k_surface_drawn = "surface_drawn";

void check_overrides(std::span<const std::string> overrides, const std::string& section) {
  std::vector<Problem> problems;
  for (const std::string& setting : overrides) {
    const std::string key = setting.substr(0, setting.find('='));
    if (key.starts_with(section + ".")) continue;
    const bool seen = section == "render" && key.starts_with("collider[") && key.ends_with("].visible");
    if (seen) continue;
    problems.push_back({"", 0, 0, "--set " + setting, "only keys of " + section + " can be changed here"});
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
}

/// How surfaces are drawn, as a scene file says it: its section of that name.
std::string surface_section(const std::string& scene_text) {
  const std::size_t begin = scene_text.find("[surface]\n");
  return scene_text.substr(begin, scene_text.find("\n[", begin) - begin);
}

/// The text of a cache's scene with surfaces as the run drew them, whatever was changed since: each call of
/// `mallow surface` says by itself what is other than in the run. What the user wrote into scene.toml in the
/// meantime counts as the run's. Notes in the report what the run's settings are.
std::string with_surface_as_run(const Scene& scene, nlohmann::ordered_json& report) {
  std::string text = print_scene(scene);
  const std::string now = surface_section(text);
  if (report.contains(k_surface_as_run) && report.value(k_surface_drawn, nlohmann::ordered_json()) == now &&
      report[k_surface_as_run].is_string())
    return text.replace(text.find(now), now.size(), report[k_surface_as_run].get<std::string>());
  report[k_surface_as_run] = now;
  return text;
}

}  // namespace

CachedRun open_cached_run(const CachedRunOptions& options, const std::string& section) {
  check_overrides(options.overrides, section);
  const bool writes = !section.empty();
  const Cache::Access access = options.shared ? Cache::Access::share : Cache::Access::write;
  Cache cache = Cache::open(options.folder, writes ? access : Cache::Access::read);
  // Scene and report belong together: not one from before another process wrote them, one from after.
  const auto lock = writes && options.shared ? lock_shared_folder(options.folder) : nullptr;
  // A cache stands anywhere, its scene's files where they were; from here on none of them is read.
  constexpr SceneReadOptions k_anywhere{.allow_outside_paths = true};
  nlohmann::ordered_json report = read_report(cache.report_file());
  const Scene scene =
      section == "surface"
          ? parse_scene(with_surface_as_run(read_scene(cache.scene_file(), {}, k_anywhere), report),
                        cache.scene_file(), options.overrides, k_anywhere)
          : read_scene(cache.scene_file(), options.overrides, k_anywhere);
  std::vector<float> spacings = body_spacings(report, cache.report_file());
  if (spacings.size() != body_materials(scene).size()) {
    throw IoError({cache.report_file().string(), 0, 0, "groups", "does not list the groups of scene.toml"});
  }
  if (writes) Cache::refuse_inputs(options.folder, InputFiles(scene), "", false);
  return {std::move(cache), std::move(scene), std::move(report), std::move(spacings),
          resolve_threads(options.threads)};
}

void close_cached_run(CachedRun& run, const StageTimes& seconds, std::span<const Stage> stages) {
  for (const Stage stage : stages) {
    run.report["stage_seconds"][name(stage)] = seconds[static_cast<std::size_t>(stage)];
  }
  run.cache.write_scene(run.scene);
  if (run.report.contains(k_surface_as_run))
    run.report[k_surface_drawn] = surface_section(print_scene(run.scene));
  write_report(run.cache.report_file(), run.report);
}

}  // namespace mallow::program

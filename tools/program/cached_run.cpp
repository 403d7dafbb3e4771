#include "program/cached_run.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "mallow/errors.h"
#include "program/input_files.h"
#include "program/machine.h"

namespace mallow::program {
namespace {

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

}  // namespace

CachedRun open_cached_run(const CachedRunOptions& options, const std::string& section) {
  check_overrides(options.overrides, section);
  const bool writes = !section.empty();
  Cache cache = Cache::open(options.folder, writes ? Cache::Access::write : Cache::Access::read);
  // A cache stands anywhere, its scene's files where they were; from here on none of them is read.
  Scene scene = read_scene(cache.scene_file(), options.overrides, {.allow_outside_paths = true});
  nlohmann::ordered_json report = read_report(cache.report_file());
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
  write_report(run.cache.report_file(), run.report);
}

}  // namespace mallow::program

#include "program/cached_run.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "mallow/errors.h"
#include "program/body_appearances.h"
#include "program/input_files.h"
#include "program/machine.h"
#include "program/shared_frames.h"

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

/// Names in report.json: a section of the scene as the run had it, and as the last call that changed it left
/// it.
std::string as_run(const std::string& section) {
  return section + "_as_run";
}
std::string as_left(const std::string& section) {
  return section + "_drawn";
}

/// How surfaces or pictures are made, as a scene file says it: its section of that name.
std::string text_of(const std::string& section, const std::string& scene_text) {
  const std::size_t begin = scene_text.find("[" + section + "]\n");
  return scene_text.substr(begin, scene_text.find("\n[", begin) - begin);
}

/// Which colliders are seen, in their order.
std::vector<bool> seen_colliders(const Scene& scene) {
  std::vector<bool> seen;
  for (const SceneCollider& collider : scene.colliders) seen.push_back(collider.visible);
  return seen;
}

/// The text of a cache's scene with a section as the run had it, whatever was changed since: each call of
/// `mallow surface` and `mallow render` says by itself what is other than in the run. What the user wrote
/// into scene.toml in the meantime counts as the run's. Notes in the report what the run's settings are.
std::string with_section_as_run(Scene scene, const std::string& section, nlohmann::ordered_json& report) {
  const std::string now = text_of(section, print_scene(scene));
  const std::vector<bool> seen = seen_colliders(scene);
  const bool is_ours = report.contains(as_run(section)) && report[as_run(section)].is_string() &&
                       report.value(as_left(section), nlohmann::ordered_json()) == now;
  std::string then = now;
  if (is_ours)
    then = report[as_run(section)].get<std::string>();
  else
    report[as_run(section)] = now;
  if (section == "render") {
    const nlohmann::ordered_json noted = report.value(as_run("visible"), nlohmann::ordered_json());
    const bool is_left = noted.is_array() && noted.size() == seen.size() &&
                         report.value(as_left("visible"), nlohmann::ordered_json()) == seen;
    for (std::size_t c = 0; c < seen.size(); ++c)
      if (is_left && noted[c].is_boolean()) scene.colliders[c].visible = noted[c].get<bool>();
    if (!is_left) report[as_run("visible")] = seen;
  }
  std::string text = print_scene(scene);
  return text.replace(text.find(now), now.size(), then);
}

}  // namespace

CachedRun open_cached_run(const CachedRunOptions& options, const std::string& section) {
  check_overrides(options.overrides, section);
  const bool writes = !section.empty();
  const Cache::Access access = options.shared ? Cache::Access::share : Cache::Access::write;
  const Cache::Access reads = options.looks ? Cache::Access::look : Cache::Access::read;
  Cache cache = Cache::open(options.folder, writes ? access : reads);
  // Scene and report belong together: not one from before another process wrote them, one from after.
  const auto lock = writes && options.shared ? lock_shared_folder(options.folder) : nullptr;
  // A cache stands anywhere, its scene's files where they were; from here on none of them is read.
  constexpr SceneReadOptions k_anywhere{.allow_outside_paths = true};
  nlohmann::ordered_json report = read_report(cache.report_file());
  Scene scene = read_scene(cache.scene_file(), {}, k_anywhere);
  if (writes)
    scene = parse_scene(with_section_as_run(std::move(scene), section, report), cache.scene_file(),
                        options.overrides, k_anywhere);
  std::vector<SlotBody> bodies = slot_bodies(report, cache.report_file());
  // There may be more: what was thrown at a scene before it was saved.
  if (bodies.size() < body_materials(scene).size()) {
    throw IoError({cache.report_file().string(), 0, 0, "groups", "does not list the groups of scene.toml"});
  }
  if (writes) Cache::refuse_inputs(options.folder, InputFiles(scene), "", false);
  std::vector<PastBody> past = past_bodies(report, cache.report_file());
  return {std::move(cache),  std::move(scene), std::move(report),
          std::move(bodies), std::move(past),  resolve_threads(options.threads)};
}

std::vector<SlotBody> CachedRun::bodies_at(int frame) const {
  return slot_bodies_at(frame, bodies, past);
}

void close_cached_run(CachedRun& run, const StageTimes& seconds, std::span<const Stage> stages) {
  for (const Stage stage : stages) {
    run.report["stage_seconds"][name(stage)] = seconds[static_cast<std::size_t>(stage)];
  }
  run.cache.write_scene(run.scene);
  for (const std::string section : {"surface", "render"})
    if (run.report.contains(as_run(section)))
      run.report[as_left(section)] = text_of(section, print_scene(run.scene));
  if (run.report.contains(as_run("visible"))) run.report[as_left("visible")] = seen_colliders(run.scene);
  write_report(run.cache.report_file(), run.report);
}

}  // namespace mallow::program

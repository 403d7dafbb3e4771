#include "cli/resumed_scene.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "cli/messages.h"
#include "mallow/errors.h"
#include "program/scene_changes.h"
#include "program/shell_word.h"

namespace mallow::cli {
namespace {

/// What of a scene counts when a run goes on.
bool counts_when_resumed(const std::string& key) {
  const bool hides_collider = key.starts_with("collider[") && key.ends_with("].visible");
  return key.starts_with("surface.") || key.starts_with("render.") || key == "run.frames" || hides_collider;
}

std::string or_left_out(const std::string& value) {
  return value.empty() ? "left out" : value;
}

/// The scene that a run goes on with, without some of what the command line changes in it.
Scene scene_now(const program::Cache& cache, SceneOptions options, bool with_overrides, bool with_quality) {
  if (!with_overrides) options.overrides.clear();
  if (!with_quality) options.quality.reset();
  return cache.moved_here(read_scene(options));
}

using SceneKeys = std::set<std::string>;

/// Refuses options of the command line that ask a run that goes on to move otherwise than it began, and says
/// on stderr what the others do. began: the scene of the run. Returns the keys that this speaks of.
SceneKeys check_late_options(const program::Cache& cache, const SceneOptions& given, const Scene& began) {
  const std::string folder = program::shell_word(cache.folder().string());
  std::vector<Problem> problems;
  std::vector<std::string> warnings;
  SceneKeys told;
  const Scene after = scene_now(cache, given, true, true);
  std::vector<program::SceneChange> of_run = program::scene_changes(began, after);
  std::erase_if(of_run, [](const program::SceneChange& change) { return change.key == "run.frames"; });
  if (of_run.empty()) return told;
  const auto look = [&](const Scene& before, const std::string& option) {
    std::string refused;
    for (const program::SceneChange& change : program::scene_changes(before, after)) {
      const auto differs = std::ranges::find(of_run, change.key, &program::SceneChange::key);
      if (differs == of_run.end()) continue;
      told.insert(change.key);
      const std::string before_and_now =
          change.key + " is " + or_left_out(change.now) + ", was " + or_left_out(differs->before);
      if (!counts_when_resumed(change.key))
        refused += (refused.empty() ? "" : "; ") + before_and_now;
      else
        warnings.push_back(option + ": " + before_and_now + ": from the next frame on; `mallow " +
                           (change.key.starts_with("surface.") ? "surface " : "render ") + folder +
                           " --set ...` draws all frames alike");
    }
    if (!refused.empty())
      problems.push_back({"", 0, 0, option,
                          "is not allowed with --resume, as a run that goes on moves as it began (" +
                              refused + "); leave it out, or begin another run: mallow run SCENE " + option +
                              " ... --out OTHER"});
  };
  if (!given.overrides.empty()) look(scene_now(cache, given, false, true), "--set");
  if (given.quality)
    look(scene_now(cache, given, true, false), std::string("--quality ") + name(*given.quality));
  if (!problems.empty()) throw ConfigError(std::move(problems));
  for (const std::string& warning : warnings) print_warning(warning);
  return told;
}

/// Takes over what counts of a scene that is not the checkpoint's any more, and says on stderr what differs
/// but for keys that it was told of. own: it is the scene.toml of the run, which then says again how the run
/// began. file: where it was read.
void take_changes(const Scene& now, bool own, const std::string& file, const SceneKeys& told, Scene& scene) {
  std::string said;
  bool put_back = false;
  for (const program::SceneChange& change : program::scene_changes(scene, now)) {
    // To go on longer is no change of what is there.
    if (change.key == "run.frames" || told.contains(change.key)) continue;
    said += "\n  " + change.key + " is " + or_left_out(change.now) + ", was " + or_left_out(change.before) +
            (counts_when_resumed(change.key) ? ": from the next frame on" : ": without effect");
    put_back = put_back || (own && !counts_when_resumed(change.key));
  }
  if (put_back) said += "\n  scene.toml is put back to what has an effect";
  if (!said.empty())
    print_warning(
        file + (own ? " has changed since the run began" : " is not as the scene that the run began with") +
        "; the motion continues as it began:" + said);
  scene.surface = now.surface;
  scene.render = now.render;
  for (std::size_t i = 0; i < std::min(scene.colliders.size(), now.colliders.size()); ++i)
    scene.colliders[i].visible = now.colliders[i].visible;
  scene.run.frames = now.run.frames;
}

}  // namespace

Scene take_scene(const program::Cache& cache, const SceneOptions& options, program::CheckpointedRun& saved) {
  SceneOptions now = options;
  std::error_code unknown;
  const bool own = now.file.empty() || std::filesystem::equivalent(now.file, cache.scene_file(), unknown);
  if (own) now.file = cache.scene_file().string();
  now.allow_outside_paths = true;  // what it names is not read: the particles are there
  // Its scene.toml was turned by its quality already, behind --set.
  if (own && !saved.report.quality.empty()) {
    if (now.quality && saved.report.quality == name(*now.quality)) now.quality.reset();
    std::erase_if(now.overrides, [&](const std::string& setting) {
      return std::ranges::find(saved.report.overrides, setting) != saved.report.overrides.end();
    });
  }
  Scene scene = read_scene(now);
  const SceneKeys told = check_late_options(cache, now, saved.scene);
  take_changes(cache.moved_here(scene), own, now.file, told, saved.scene);
  return scene;
}

}  // namespace mallow::cli

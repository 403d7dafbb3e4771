#include "mallow/scene_options.h"

#include <map>

namespace mallow::cli {

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.file, "Scene file (TOML)")->required();
  command
      .add_option("--set", options.overrides,
                  "Change a value of the scene: section.key=value, any number of times")
      ->allow_extra_args(false);
  std::map<std::string, Quality> names;
  for (const Quality quality : qualities()) names[name(quality)] = quality;
  command
      .add_option("--quality", options.quality,
                  "Turn the scene's settings between speed and accuracy: realtime, balanced, accurate")
      ->transform(CLI::CheckedTransformer(names));
  command.add_flag(
      "--allow-outside-paths", options.allow_outside_paths,
      "Meshes and points that the scene names may lie outside of its folder; give it for scenes that you "
      "trust");
}

Scene read_scene(const SceneOptions& options) {
  const Scene scene = mallow::read_scene(options.file, options.overrides,
                                         {.allow_outside_paths = options.allow_outside_paths});
  return options.quality ? with_quality(scene, *options.quality) : scene;
}

}  // namespace mallow::cli

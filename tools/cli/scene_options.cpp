#include "cli/scene_options.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace mallow::cli {

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.file, "Scene file (TOML)")->required();
  command
      .add_option("--set", options.overrides,
                  "Change a value of the scene: --set solver.time_step=0.001 --set body[0].material=honey; "
                  "'mallow keys' lists what there is")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  std::vector<std::string> names;
  for (const Quality quality : qualities()) names.emplace_back(name(quality));
  command
      .add_option_function<std::string>(
          "--quality",
          [&options](const std::string& given) {
            for (const Quality quality : qualities())
              if (name(quality) == given) options.quality = quality;
          },
          "Turn the scene's settings between speed and accuracy")
      ->check(CLI::IsMember(names));
  command.add_flag(
      "--allow-outside-paths", options.allow_outside_paths,
      "Allow the scene to name meshes and points outside its folder; only for scenes that you trust");
}

Scene read_scene(const SceneOptions& options) {
  const Scene scene = mallow::read_scene(options.file, options.overrides,
                                         {.allow_outside_paths = options.allow_outside_paths});
  return options.quality ? with_quality(scene, *options.quality) : scene;
}

}  // namespace mallow::cli

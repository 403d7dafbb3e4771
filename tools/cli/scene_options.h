#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mallow/scene.h"

namespace CLI {
class App;
}

namespace mallow::cli {

/// Which scene a command takes, and what is changed in it.
struct SceneOptions {
  std::string file;
  std::vector<std::string> overrides;
  std::optional<Quality> quality;  ///< turns what file and overrides say
  bool allow_outside_paths = false;
};
/// SCENE, --set, --quality and --allow-outside-paths.
void add_scene_options(CLI::App& command, SceneOptions& options);
Scene read_scene(const SceneOptions& options);

}  // namespace mallow::cli

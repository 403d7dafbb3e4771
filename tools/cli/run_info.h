#pragma once

#include "cli/scene_options.h"

namespace mallow::cli {

/// Prints what a folder holds of a run: its scene, how far it came and how it ended. options.file: the
/// folder. prints_scene: only its scene, with every value in it. Also while the run is on: every file of it
/// is whole. Throws IoError where it holds no run, and ConfigError where options would change its scene.
void print_run(const SceneOptions& options, bool prints_scene);

}  // namespace mallow::cli

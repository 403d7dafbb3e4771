#pragma once

#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow::program {

/// A key of a scene whose value is another one than before.
struct SceneChange {
  std::string key;          ///< "solver.time_step", "material[0].alpha"
  std::string before, now;  ///< as TOML; empty where it is left out
};

/// In the order of the scene file. Paths count as different where they are written differently.
std::vector<SceneChange> scene_changes(const Scene& before, const Scene& now);

}  // namespace mallow::program

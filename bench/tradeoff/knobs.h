#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow::bench {

/// A knob of the user's turned to somewhere: what one would type after --set.
struct Setting {
  std::string knobs;  ///< "time_step", "time_step+region_stride"; "as written" for none
  std::string label;  ///< "dt 0.3", "dt 0.3, stride 2"
  std::vector<std::string> overrides = {};
  double time_step_factor = 1;  ///< see at_time_step: the material stays the same
  std::optional<Quality> quality = {};
  bool baseline() const { return overrides.empty() && time_step_factor == 1 && !quality; }
};

/// Every knob that the motion of a scene can have.
std::span<const std::string> knob_names();

/// Each of `knobs` alone over its range, then the cheap ones combined, as far as the scene has a use for
/// them: no region stride for a fluid, no neighbour slack for an elastic solid. The scene as written comes
/// first. small: a few settings, for tests. The scene's first body is a box, and its spacing and radii are
/// what the ranges are made from.
std::vector<Setting> make_settings(const Scene& scene, std::span<const std::string> knobs, bool small);

/// The scene in a cube of `side` particles a side.
Setting fewer_particles(const Scene& scene, int side);

/// A scene at a setting.
Scene read_scene_at(const std::filesystem::path& file, const Setting& setting);

}  // namespace mallow::bench

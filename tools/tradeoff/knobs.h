#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow::tradeoff {

/// A way to run a scene.
struct Setting {
  std::string name;
  Scene scene;
  double cost = 1;                      ///< guessed, of that of the scene as it is
  std::optional<Quality> quality = {};  ///< where it is one
};

/// "key=a,b,c" of a user: the key of a scene file at each value.
struct Knob {
  std::string key;
  std::vector<std::string> values;
};
/// Throws ConfigError where the text is not of that form. Commas in brackets and quotes part no values.
Knob parse_knob(const std::string& text);

/// What a scene has that knobs can turn.
struct SceneTraits {
  bool regions = false;  ///< of shape matching
  bool sums = false;     ///< of SPH or of the volume iterations
  bool surface = false;  ///< that is drawn
};
SceneTraits traits(const SimulationInfo& info);

/// Settings around that of a scene, the most telling first; that of the scene itself is not among them.
std::vector<Setting> settings_around(const Scene& scene, const SceneTraits& traits);
/// The scene at each value of a knob. overrides: those that led to `scene`. Throws ConfigError where a value
/// is not one.
std::vector<Setting> turned(const Scene& scene, const Knob& knob, const std::vector<std::string>& overrides,
                            bool allow_outside_paths);

/// Settings a turn of one knob away from another, named after both, cheaper ones first: where a search goes
/// on.
std::vector<Setting> settings_from(const Setting& from, const SceneTraits& traits);

/// In steps of `factor` times the scene's, and with a region for every particle: what others are judged by.
Scene finest(const Scene& scene, float factor);

/// What is to be pasted into the scene to have a setting: TOML, by section.
std::string lines_to_paste(const Scene& scene, const Scene& setting);

}  // namespace mallow::tradeoff

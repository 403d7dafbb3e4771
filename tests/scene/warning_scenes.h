#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow {

/// A body of a spacing under a gravity, in a film of 30 frames; `run`: lines of that section.
inline std::string falling(const std::string& spacing, const std::string& radius, const std::string& gravity,
                           const std::string& run) {
  return "[solver]\nsupport_radius = " + radius + "\ngravity = [0, 0, " + gravity +
         "]\n[[material]]\nname = \"blob\"\nalpha = 0.3\nrest_density = 1000.0\n[[body]]\nmaterial = "
         "\"blob\"\nbox = { count = [4, 4, 4], spacing = " +
         spacing + ", corner = [0, 0, 0] }\n[run]\nframes = 30\n" + run;
}

/// The same with other lines of the material, and more sections.
inline std::string jelly(const std::string& material, const std::string& more = "") {
  std::string text = falling("0.1", "0.21", "-9.81", "frame_time = 0.0333333\n");
  const std::string alpha = "alpha = 0.3";
  text.replace(text.find(alpha), alpha.size(), material);
  return text + more;
}

inline std::vector<std::string> warnings_of(const Scene& scene) {
  return warnings(scene, build(scene, 1).info());
}

inline bool warns(const std::vector<std::string>& all, const std::string& of) {
  return std::ranges::any_of(all, [&](const std::string& text) { return text.find(of) != text.npos; });
}

}  // namespace mallow

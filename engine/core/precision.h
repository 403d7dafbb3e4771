#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

#include "mallow/vec3.h"

namespace mallow {

/// Floats tell neighbouring points apart where the spacing is at least this many steps from one float to the
/// next: rounding then moves a point by a sixteenth of the spacing at most.
inline constexpr float k_least_float_steps = 8;

/// "0.5 1 -2", with the digits that a float has.
inline std::string text_of(const Vec3& place) {
  std::ostringstream text;
  text.precision(8);
  text << place.x() << ' ' << place.y() << ' ' << place.z();
  return text.str();
}

/// From |x| to the next larger float.
inline float float_step(float x) {
  return std::nextafter(std::abs(x), std::numeric_limits<float>::infinity()) - std::abs(x);
}

/// Why points with this spacing cannot be at `place`, in words; nothing where they can.
inline std::optional<std::string> why_too_far(const Vec3& place, float spacing) {
  const float step = float_step(place.cwiseAbs().maxCoeff());
  if (!(spacing < k_least_float_steps * step)) return std::nullopt;
  std::ostringstream text;
  text << '(' << text_of(place) << ") is too far from 0 for a spacing of " << spacing
       << ": floats are steps of " << step << " there, and neighbouring points need " << k_least_float_steps
       << " steps or more between them; move the body nearer to 0, or take a larger spacing";
  return text.str();
}

}  // namespace mallow

#pragma once

#include "mallow/vec3.h"

namespace mallow {

/// Whether gravity is that of a planet or moon in metres and seconds, by its size.
inline bool is_in_metres(const Vec3& gravity) {
  constexpr float k_moon = 1.5f, k_jupiter = 30;  // [m/s²]
  const float size = gravity.norm();
  return size >= k_moon && size <= k_jupiter;
}

/// Whether it is that of no such place, so that units are a scene's own and none of SI stands for them;
/// without gravity they may be SI's.
inline bool has_free_units(const Vec3& gravity) {
  return gravity != Vec3::Zero() && !is_in_metres(gravity);
}

/// What stands behind a number, in units of SI; nothing where a scene has its own.
inline const char* unit_of(const Vec3& gravity, const char* name) {
  return has_free_units(gravity) ? "" : name;
}

}  // namespace mallow

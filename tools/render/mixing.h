#pragma once

#include <algorithm>

#include "mallow/vec3.h"

namespace mallow::render {

/// 0 up to `from`, 1 beyond `to`, smooth between.
inline float smoothstep(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

inline Vec3 mix(const Vec3& a, const Vec3& b, float t) {
  return a + (b - a) * t;
}

}  // namespace mallow::render

#pragma once

#include <algorithm>
#include <limits>

#include "mallow/body.h"
#include "mallow/vec3.h"

namespace mallow::render {

struct Ray {
  Vec3 origin;
  Vec3 direction;     ///< unit length
  float time = 0.5f;  ///< within the shutter's opening, in [0, 1]
  Vec3 at(float t) const { return origin + t * direction; }
};
inline constexpr float k_far = std::numeric_limits<float>::infinity();

/// Whether a ray comes through a box.
inline bool meets(const Ray& ray, const Aabb& box) {
  float enter = 0, leave = k_far;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const float inverse = 1 / ray.direction[axis];
    const float a = (box.min[axis] - ray.origin[axis]) * inverse;
    const float b = (box.max[axis] - ray.origin[axis]) * inverse;
    // In this order NaN, of a ray in a side's plane, changes nothing.
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

}  // namespace mallow::render

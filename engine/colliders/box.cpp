#include "colliders/box.h"

#include <algorithm>
#include <cmath>

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, box_lanes)

const ColliderLanes& ShapeTraits<Box>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, box_lanes);
}

std::optional<ShapeProblem> ShapeTraits<Box>::problem(const Box& box) {
  if ((box.min.array() < box.max.array()).all()) return std::nullopt;
  return ShapeProblem{"max", "above min along every axis"};
}

ShapeNumbers ShapeTraits<Box>::numbers(const Box& box, const Eigen::Vector3d& by) {
  const Vec3 min = (box.min.cast<double>() + by).cast<float>();
  const Vec3 max = (box.max.cast<double>() + by).cast<float>();
  return {{min[0], min[1], min[2], max[0], max[1], max[2]}, box.inside};
}

Crossings ShapeTraits<Box>::cross(const Box& box, const Vec3& origin, const Vec3& direction) {
  constexpr float k_far = std::numeric_limits<float>::infinity();
  Crossings result{Crossing{-k_far, {0, 0, 0}}, Crossing{k_far, {0, 0, 0}}, Crossing{}, Crossing{}};
  for (int axis = 0; axis < 3; ++axis) {
    const float speed = direction[axis];
    const float low = box.min[axis] - origin[axis];
    const float high = box.max[axis] - origin[axis];
    if (speed == 0) {
      if (low > 0 || high < 0) return {};
      continue;
    }
    const float in = (speed > 0 ? low : high) / speed;
    const float out = (speed > 0 ? high : low) / speed;
    const Vec3 outward = Vec3::Unit(axis) * (box.inside ? -1.0f : 1.0f);
    if (in > result[0].t) result[0] = {in, speed > 0 ? Vec3(-outward) : outward};
    if (out < result[1].t) result[1] = {out, speed > 0 ? outward : Vec3(-outward)};
  }
  if (result[0].t > result[1].t) return {};
  return result;
}

float ShapeTraits<Box>::edge_distance(const Box& box, const Vec3& x) {
  std::array<float, 3> gaps;
  for (int axis = 0; axis < 3; ++axis)
    gaps[static_cast<std::size_t>(axis)] =
        std::min(std::abs(x[axis] - box.min[axis]), std::abs(x[axis] - box.max[axis]));
  std::sort(gaps.begin(), gaps.end());
  return gaps[1];
}

Aabb bounds(const Box& box) {
  return {box.min, box.max};
}

}  // namespace mallow

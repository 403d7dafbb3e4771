#include "colliders/distance_field.h"

#include <algorithm>
#include <cmath>

#include "mallow/errors.h"

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, distance_field_lanes)

namespace {

std::size_t points_of(const std::array<int, 3>& size) {
  std::size_t count = 1;
  for (const int along : size) count *= static_cast<std::size_t>(along);
  return count;
}

Vec3 last_point(const DistanceGrid& grid) {
  return grid.origin + grid.voxel_size * Vec3(static_cast<float>(grid.size[0] - 1),
                                              static_cast<float>(grid.size[1] - 1),
                                              static_cast<float>(grid.size[2] - 1));
}

/// The part of a line in a box; empty where first > last.
std::pair<float, float> clipped(const Aabb& box, const Vec3& origin, const Vec3& direction) {
  float first = 0, last = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const float low = (box.min[axis] - origin[axis]) / direction[axis];
    const float high = (box.max[axis] - origin[axis]) / direction[axis];
    if (direction[axis] == 0) {
      if (origin[axis] < box.min[axis] || origin[axis] > box.max[axis]) return {1, 0};
      continue;
    }
    first = std::max(first, std::min(low, high));
    last = std::min(last, std::max(low, high));
  }
  return {first, last};
}

}  // namespace

const ColliderLanes& ShapeTraits<DistanceField>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, distance_field_lanes);
}

std::optional<ShapeProblem> ShapeTraits<DistanceField>::problem(const DistanceField& field) {
  if (!field.grid) return ShapeProblem{"grid", "a grid of distances"};
  const DistanceGrid& grid = *field.grid;
  if (!grid.origin.allFinite() || !(grid.voxel_size > 0 && std::isfinite(grid.voxel_size)))
    return ShapeProblem{"grid", "a grid with a finite origin and a voxel size above 0"};
  for (const int along : grid.size)
    if (along < 2 || along > k_most_grid_points)
      return ShapeProblem{"grid", "a grid of 2 to 1024 points along each axis"};
  if (grid.distances.size() != points_of(grid.size))
    return ShapeProblem{"grid", "a grid with a distance for each of its points"};
  for (const float distance : grid.distances)
    if (!std::isfinite(distance)) return ShapeProblem{"grid", "a grid of finite distances"};
  return std::nullopt;
}

ShapeNumbers ShapeTraits<DistanceField>::numbers(const DistanceField& field, const Eigen::Vector3d& by) {
  const DistanceGrid& grid = *field.grid;
  const Vec3 origin = (grid.origin.cast<double>() + by).cast<float>();
  ShapeNumbers numbers{.at = {origin[0], origin[1], origin[2], grid.voxel_size}, .inside = field.inside};
  numbers.data[0] = grid.distances.data();
  for (std::size_t k = 0; k < 3; ++k) numbers.sizes[k] = static_cast<std::size_t>(grid.size[k]);
  return numbers;
}

Crossings ShapeTraits<DistanceField>::cross(const DistanceField& field, const Vec3& origin,
                                            const Vec3& direction) {
  const DistanceGrid& grid = *field.grid;
  const float voxel = grid.voxel_size;
  const auto [first, last] = clipped({grid.origin, last_point(grid)}, origin, direction);
  Crossings result;
  std::size_t found = 0;
  const auto distance = [&](float t) { return nearest(field, origin + t * direction).distance; };
  // What starts at the surface does not meet it there.
  float t = std::max(first, 0.25f * voxel);
  for (float before = distance(t); t < last && found < result.size();) {
    const float next = t + std::max(std::abs(before), 0.25f * voxel);
    const float after = distance(next);
    if ((before > 0) != (after > 0)) {
      float low = t, high = next;
      for (int halving = 0; halving < 16; ++halving) {
        const float middle = 0.5f * (low + high);
        ((distance(middle) > 0) == (before > 0) ? low : high) = middle;
      }
      result[found++] = {high, nearest(field, origin + high * direction).normal};
    }
    t = next;
    before = after;
  }
  return result;
}

Aabb bounds(const DistanceField& field) {
  const DistanceGrid& grid = *field.grid;
  constexpr float k_far = std::numeric_limits<float>::infinity();
  Aabb box{Vec3::Constant(k_far), Vec3::Constant(-k_far)};
  const std::size_t strides[3] = {
      1, static_cast<std::size_t>(grid.size[0]),
      static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1])};
  for (int z = 0; z < grid.size[2]; ++z)
    for (int y = 0; y < grid.size[1]; ++y)
      for (int x = 0; x < grid.size[0]; ++x) {
        const int at[3] = {x, y, z};
        const std::size_t i = static_cast<std::size_t>(x) + strides[1] * static_cast<std::size_t>(y) +
                              strides[2] * static_cast<std::size_t>(z);
        for (int axis = 0; axis < 3; ++axis) {
          if (at[axis] + 1 == grid.size[static_cast<std::size_t>(axis)]) continue;
          const float a = grid.distances[i], b = grid.distances[i + strides[axis]];
          if ((a > 0) == (b > 0)) continue;
          Vec3 point(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
          point[axis] += a / (a - b);
          point = grid.origin + grid.voxel_size * point;
          box.min = box.min.cwiseMin(point);
          box.max = box.max.cwiseMax(point);
        }
      }
  return box;
}

}  // namespace mallow

#include "colliders/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, hull_lanes)

const ColliderLanes& ShapeTraits<ConvexHull>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, hull_lanes);
}

std::optional<ShapeProblem> ShapeTraits<ConvexHull>::problem(const ConvexHull& hull) {
  if (!hull.data) return ShapeProblem{"data", "made by convex_hull()"};
  const auto is_unit = [](const std::array<float, 4>& plane) {
    return std::abs(Vec3(plane[0], plane[1], plane[2]).norm() - 1) < 1e-4f && std::isfinite(plane[3]);
  };
  const auto is_edge = [](const HullData::Edge& edge) {
    return Vec3(edge.start.data()).allFinite() && std::abs(Vec3(edge.direction.data()).norm() - 1) < 1e-4f &&
           std::isfinite(edge.length) && edge.length >= 0;
  };
  const HullData& data = *hull.data;
  if (data.planes.size() < 4 || data.edges.size() < 6 || data.corners.size() < 4 ||
      !std::all_of(data.planes.begin(), data.planes.end(), is_unit) ||
      !std::all_of(data.edges.begin(), data.edges.end(), is_edge) ||
      !std::all_of(data.corners.begin(), data.corners.end(), [](const Vec3& x) { return x.allFinite(); }) ||
      !(data.rounding >= 0 && std::isfinite(data.rounding)))
    return ShapeProblem{"data",
                        "planes of unit normals and edges that are finite, as convex_hull() makes them"};
  return std::nullopt;
}

ShapeNumbers ShapeTraits<ConvexHull>::numbers(const ConvexHull& hull, const Eigen::Vector3d& by) {
  const HullData& data = *hull.data;
  const Vec3 at = by.cast<float>();
  static_assert(sizeof(HullData::Edge) == 7 * sizeof(float));
  float reach = 0;
  for (const auto& plane : data.planes) reach = std::max(reach, std::abs(plane[3]));
  return {.at = {at[0], at[1], at[2], reach, data.rounding},
          .inside = hull.inside,
          .data = {data.planes.front().data(), data.edges.front().start.data()},
          .sizes = {data.planes.size(), data.edges.size()}};
}

Crossings ShapeTraits<ConvexHull>::cross(const ConvexHull& hull, const Vec3& origin, const Vec3& direction) {
  constexpr float k_far = std::numeric_limits<float>::infinity();
  Crossings result{Crossing{-k_far, {0, 0, 0}}, Crossing{k_far, {0, 0, 0}}, Crossing{}, Crossing{}};
  for (const auto& plane : hull.data->planes) {
    const Vec3 outward(plane.data());
    const float speed = outward.dot(direction), gap = outward.dot(origin) - plane[3];
    if (speed == 0) {
      if (gap > 0) return {};
      continue;
    }
    Crossing& bound = result[speed < 0 ? 0 : 1];
    const float t = -gap / speed;
    if (speed < 0 ? t > bound.t : t < bound.t) bound = {t, hull.inside ? Vec3(-outward) : outward};
  }
  if (result[0].t > result[1].t) return {};
  return result;
}

float ShapeTraits<ConvexHull>::edge_distance(const ConvexHull& hull, const Vec3& x) {
  float least = std::numeric_limits<float>::infinity();
  for (const HullData::Edge& edge : hull.data->edges) {
    const Vec3 offset = x - Vec3(edge.start.data()), direction(edge.direction.data());
    const float along = std::clamp(offset.dot(direction), 0.0f, edge.length);
    least = std::min(least, (offset - along * direction).norm());
  }
  return least;
}

Aabb bounds(const ConvexHull& hull) {
  Aabb box{hull.data->corners.front(), hull.data->corners.front()};
  for (const Vec3& corner : hull.data->corners) {
    box.min = box.min.cwiseMin(corner);
    box.max = box.max.cwiseMax(corner);
  }
  return box;
}

}  // namespace mallow

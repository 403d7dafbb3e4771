#include "colliders/ways.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "colliders/pose.h"
#include "core/bounds.h"

namespace mallow {
namespace {

/// What is so much longer than it is thick, and moves across its thickness, is meant to cut.
constexpr float k_flat = 4;
/// Share of a way that may be along the thickness of what cuts.
constexpr double k_edgewise = 0.5;
/// Of the speed of the fastest corner, what others have whose way counts: near its axis a door turns
/// edgewise.
constexpr double k_fast = 0.5;

/// Velocities of the eight corners of a box, in its own frame [m/s].
using Ways = std::array<Eigen::Vector3d, 8>;

Ways ways_of(const Twist& twist, const Pose& pose, const Aabb& box) {
  const Eigen::Matrix3d to_own = rotation_of(pose).transpose();
  const Eigen::Vector3d velocity = to_own * twist.velocity.cast<double>();
  const Eigen::Vector3d spin = to_own * twist.angular_velocity.cast<double>();
  Ways ways;
  for (unsigned k = 0; k < ways.size(); ++k) {
    const Vec3 corner((k & 1) != 0 ? box.max.x() : box.min.x(), (k & 2) != 0 ? box.max.y() : box.min.y(),
                      (k & 4) != 0 ? box.max.z() : box.min.z());
    ways[k] = velocity;
    if (!spin.isZero(0)) ways[k] += spin.cross(corner.cast<double>());
  }
  return ways;
}

/// Calls visit(ways) with those of every part of the way of a collider, as it begins and as it ends.
template <class Visit>
void visit_ways(const Collider& collider, const Aabb& box, const Visit& visit) {
  if (collider.keyframes.empty())
    return visit(ways_of({collider.velocity, collider.angular_velocity}, collider.pose, box));
  for (std::size_t k = 1; k < collider.keyframes.size(); ++k) {
    const PoseKeyframe &from = collider.keyframes[k - 1], &to = collider.keyframes[k];
    const Twist twist = twist_between(from.pose, to.pose, to.time - from.time);
    visit(ways_of(twist, from.pose, box));
    visit(ways_of(twist, to.pose, box));
  }
}

/// Around all parts, in the frame of the collider.
Aabb own_bounds(const Collider& collider) {
  Aabb box = empty_box();
  visit_parts(collider, [&](const auto& shape) { box = box_around(box, bounds(shape)); });
  return box;
}

/// Nothing is cut by its outside then.
bool is_hollow(const Collider& collider) {
  bool any = false;
  visit_parts(collider, [&](const auto& shape) {
    if constexpr (requires { shape.inside; }) any |= shape.inside;
  });
  return any;
}

double fastest_of(const Ways& ways) {
  double most = 0;
  for (const Eigen::Vector3d& way : ways) most = std::max(most, way.norm());
  return most;
}

}  // namespace

bool is_driven(const Collider& collider) {
  return !collider.keyframes.empty() || !collider.velocity.isZero(0) || !collider.angular_velocity.isZero(0);
}

float blade_thickness(const Collider& collider) {
  constexpr float k_none = std::numeric_limits<float>::infinity();
  const Aabb box = own_bounds(collider);
  const Vec3 sides = box.max - box.min;
  if (!is_driven(collider) || is_hollow(collider) || !sides.allFinite()) return k_none;
  float thickness = k_none;
  visit_ways(collider, box, [&](const Ways& ways) {
    const double most = fastest_of(ways);
    for (const Eigen::Vector3d& way : ways) {
      const double speed = way.norm();
      for (int axis = 0; axis < 3; ++axis)
        if (speed >= k_fast * most && std::abs(way[axis]) < k_edgewise * speed)
          thickness = std::min(thickness, sides[axis]);
    }
  });
  return k_flat * thickness <= sides.maxCoeff() ? thickness : k_none;
}

double greatest_corner_speed(const Collider& collider) {
  Aabb box = own_bounds(collider);
  if (!box.min.allFinite() || !box.max.allFinite()) box = {Vec3::Zero(), Vec3::Zero()};
  double most = 0;
  visit_ways(collider, box, [&](const Ways& ways) { most = std::max(most, fastest_of(ways)); });
  return most;
}

}  // namespace mallow

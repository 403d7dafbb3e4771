#pragma once

#include "colliders/shape.h"

namespace mallow {

/// What shapes of revolution turn about.
struct Axis {
  Eigen::Vector3d start;
  Eigen::Vector3d direction;  ///< from start to end, unit length
  double length;              ///< [m]
};
Axis axis_of(const Vec3& start, const Vec3& end);

/// What is wrong with the two ends of an axis.
std::optional<ShapeProblem> axis_problem(const Vec3& start, const Vec3& end);

/// A line origin + t direction as the axis sees it.
struct LineAtAxis {
  Eigen::Vector3d across, slide;  ///< from the axis, and how that changes with t
  double height, climb;           ///< along the axis from its start, and how that changes with t
  LineAtAxis(const Axis& axis, const Vec3& origin, const Vec3& direction);
};

/// The t at which a line is in something convex; nowhere where first > last.
struct Stretch {
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();
  bool is_empty() const { return first > last; }
  static Stretch none() { return {1, 0}; }
};
Stretch common(const Stretch& a, const Stretch& b);
/// Where low <= at + t speed <= high.
Stretch stretch_between(double at, double speed, double low, double high);
/// Where |offset + t way| <= radius.
Stretch stretch_within(const Eigen::Vector3d& offset, const Eigen::Vector3d& way, double radius);

}  // namespace mallow

#include "colliders/axis.h"

#include <algorithm>
#include <cmath>

namespace mallow {

Axis axis_of(const Vec3& start, const Vec3& end) {
  const Eigen::Vector3d from = start.cast<double>(), along = end.cast<double>() - from;
  const double length = along.norm();
  return {from, along / length, length};
}

std::optional<ShapeProblem> axis_problem(const Vec3& start, const Vec3& end) {
  // As of the normal of a plane: outside these lengths squares leave single precision.
  const double length = (end.cast<double>() - start.cast<double>()).norm();
  if (length >= 1e-15 && length <= 1e15) return std::nullopt;
  return ShapeProblem{"end", "a point that is [1e-15, 1e15] away from start"};
}

LineAtAxis::LineAtAxis(const Axis& axis, const Vec3& origin, const Vec3& direction) {
  const Eigen::Vector3d from = origin.cast<double>() - axis.start, way = direction.cast<double>();
  height = from.dot(axis.direction);
  climb = way.dot(axis.direction);
  across = from - height * axis.direction;
  slide = way - climb * axis.direction;
}

Stretch common(const Stretch& a, const Stretch& b) {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

Stretch stretch_between(double at, double speed, double low, double high) {
  if (speed == 0) return at >= low && at <= high ? Stretch{} : Stretch::none();
  const double to_low = (low - at) / speed, to_high = (high - at) / speed;
  return {std::min(to_low, to_high), std::max(to_low, to_high)};
}

Stretch stretch_within(const Eigen::Vector3d& offset, const Eigen::Vector3d& way, double radius) {
  const double square = way.squaredNorm();
  if (square == 0) return offset.norm() <= radius ? Stretch{} : Stretch::none();
  // From the nearest point of the line rather than from b² - 4ac, which cancels far away.
  const double middle = -offset.dot(way) / square;
  const double half_squared = radius * radius - (offset + middle * way).squaredNorm();
  if (half_squared < 0) return Stretch::none();
  const double half = std::sqrt(half_squared / square);
  return {middle - half, middle + half};
}

}  // namespace mallow

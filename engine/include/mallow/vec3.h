#pragma once

#include <Eigen/Core>

namespace mallow {

/// A point or vector in space, single precision: x, y, z [m, or the scene's unit]. `{}` leaves it unset.
using Vec3 = Eigen::Vector3f;

/// An axis-aligned box. Valid where min <= max in every component.
struct Aabb {
  Vec3 min{0, 0, 0};
  Vec3 max{0, 0, 0};
};

}  // namespace mallow

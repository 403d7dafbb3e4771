#pragma once

#include <Eigen/Core>

#include "mallow/collider.h"

namespace mallow::oracle {

/// Signed distance φ to an obstacle [m], negative inside it, and n = ∇φ.
struct Distance {
  double value;
  Eigen::Vector3d normal;
};

Distance distance(const Plane& plane, const Eigen::Vector3d& x);
Distance distance(const Sphere& sphere, const Eigen::Vector3d& x);
Distance distance(const Box& box, const Eigen::Vector3d& x);
/// The nearest part counts; of equally near ones, the first.
Distance distance(const Union& shapes, const Eigen::Vector3d& x);
Distance distance(const Collider& collider, const Eigen::Vector3d& x);

}  // namespace mallow::oracle

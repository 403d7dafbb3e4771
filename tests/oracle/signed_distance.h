#pragma once

#include <Eigen/Core>
#include <vector>

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
Distance distance(const Capsule& capsule, const Eigen::Vector3d& x);
Distance distance(const Cylinder& cylinder, const Eigen::Vector3d& x);
Distance distance(const Cone& cone, const Eigen::Vector3d& x);
/// By all triangles that three of its corners make: n³ of them.
Distance distance(const ConvexHull& hull, const Eigen::Vector3d& x);
/// Trilinear in its grid.
Distance distance(const DistanceField& field, const Eigen::Vector3d& x);
/// The nearest part counts; of equally near ones, the first.
Distance distance(const Primitive& shape, const Eigen::Vector3d& x);
Distance distance(const Union& shapes, const Eigen::Vector3d& x);
Distance distance(const Collider& collider, const Eigen::Vector3d& x);

/// What a particle meets one after the other: the parts of a union, the six faces of a box that keeps it in,
/// the ends of a cone or a cylinder that does and then itself.
std::vector<Primitive> parts_of(const Collider& collider);
/// The plane in which a particle at x meets a part on its way of one step, as the distance of x from it and
/// its normal: infinitely far where it passes by. [model 2, section 4 A]
Distance distance_on_the_way(const Primitive& part, const Eigen::Vector3d& x, const Eigen::Vector3d& way,
                             double contact_offset);

}  // namespace mallow::oracle

#pragma once

#include <Eigen/Geometry>

namespace mallow {

/// What particles of a body got from what they touch, and the means of how they touched by how much each got.
struct ContactSums {
  double weight = 0;                 ///< Σ |j| [N s]
  Eigen::Vector3d impulse{0, 0, 0};  ///< Σ j, what the body got [N s]
  Eigen::Vector3d moment{0, 0, 0};   ///< Σ x × j, about where x is 0 [N m s]
  /// The same of what the other body got, where its particles are; 0 of colliders [N m s]
  Eigen::Vector3d other_moment{0, 0, 0};
  Eigen::Vector3d position{0, 0, 0};  ///< Σ |j| x [N s m]
  Eigen::Vector3d velocity{0, 0, 0};  ///< Σ |j| v, v at the start of the step [N m]
  Eigen::Vector3d normal{0, 0, 0};    ///< Σ |j| n, towards the body; 0 where nobody said it [N s]

  void add(const Eigen::Vector3d& j, const Eigen::Vector3d& x, const Eigen::Vector3d& v,
           const Eigen::Vector3d& n = {0, 0, 0}) {
    const double share = j.norm();
    weight += share;
    impulse += j;
    moment += x.cross(j);
    position += share * x;
    velocity += share * v;
    normal += share * n;
  }
  /// j at `own` in this body, −j at `other` in the other one.
  void add_between(const Eigen::Vector3d& j, const Eigen::Vector3d& own, const Eigen::Vector3d& other,
                   const Eigen::Vector3d& v, const Eigen::Vector3d& n) {
    const Eigen::Vector3d half = 0.5 * (own - other);
    add(j, own - half, v, n);
    moment += half.cross(j);
    other_moment -= other.cross(j);
  }
  /// What `factor` times the mass would have got.
  ContactSums times(double factor) const {
    return {factor * weight,   factor * impulse,  factor * moment, factor * other_moment,
            factor * position, factor * velocity, factor * normal};
  }
  ContactSums& operator+=(const ContactSums& other) {
    weight += other.weight;
    impulse += other.impulse;
    moment += other.moment;
    other_moment += other.other_moment;
    position += other.position;
    velocity += other.velocity;
    normal += other.normal;
    return *this;
  }
  /// The same as the other body has it: what it got, and its velocity seen from this one.
  ContactSums swapped() const {
    return {weight, -impulse, other_moment, moment, position, -velocity, -normal};
  }
};

}  // namespace mallow

#pragma once

#include <Eigen/Core>

namespace mallow::oracle {

/// [TK eq. 3]
double poly6(double r, double sigma);
/// ∇ with respect to x_i, of d = x_i − x_j.
Eigen::Vector3d poly6_gradient(const Eigen::Vector3d& d, double sigma);

}  // namespace mallow::oracle

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mallow/export.h"

namespace mallow {

/// The rotation R that maximises tr(Rᵀ A): the rotation of A's polar decomposition, det +1 also where A
/// mirrors. Where A says nothing (rank below 2, or next to nothing against `scale`, the size A has at rest)
/// it stays as near `last` as can be. Exact and slow: largest eigenvector of Horn's quaternion matrix (Horn
/// 1987), in double.
MALLOW_EXPORT Eigen::Quaterniond polar_rotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& last,
                                                double scale);

}  // namespace mallow

#pragma once

#include "core/column.h"
#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// What a body does as a whole: the rigid motion that has its momentum and its spin.
struct RigidMotion {
  Eigen::Vector3d center{0, 0, 0};    ///< [m]
  Eigen::Vector3d velocity{0, 0, 0};  ///< of the centre [m/s]
  Eigen::Vector3d spin{0, 0, 0};      ///< ω [rad/s]
  double deformation_speed = 0;       ///< root of the mean square of what particles move besides [m/s]
};

/// Sums over particles of equal mass, of places relative to a point near them.
struct RigidSums {
  double count = 0;
  Eigen::Vector3d place{0, 0, 0};                           ///< Σ x
  Eigen::Vector3d velocity{0, 0, 0};                        ///< Σ v
  Eigen::Vector3d spin{0, 0, 0};                            ///< Σ x × v
  double squared_speed = 0;                                 ///< Σ v²
  Eigen::Matrix3d square{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  ///< Σ x xᵀ

  void operator+=(const RigidSums& other);
};

RigidSums sum_rigid(InstructionLevel level, ConstVectors positions, ConstVectors velocities,
                    std::size_t begin, std::size_t end, const Eigen::Vector3d& near);
/// near: that of the sums. A line of particles has no spin about itself, a single one none.
RigidMotion rigid_motion(const RigidSums& sums, const Eigen::Vector3d& near);

}  // namespace mallow

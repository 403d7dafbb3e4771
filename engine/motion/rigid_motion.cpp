#include "motion/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include "motion/motion_lanes.h"

namespace mallow {

void RigidSums::operator+=(const RigidSums& other) {
  count += other.count;
  place += other.place;
  velocity += other.velocity;
  spin += other.spin;
  squared_speed += other.squared_speed;
  square += other.square;
}

RigidSums sum_rigid(InstructionLevel level, ConstVectors positions, ConstVectors velocities,
                    std::size_t begin, std::size_t end, const Eigen::Vector3d& near) {
  double s[16];
  MALLOW_SELECT(level, motion_lanes).rigid_sums(positions, velocities, near.data(), begin, end, s);
  return {.count = static_cast<double>(end - begin),
          .place = {s[0], s[1], s[2]},
          .velocity = {s[3], s[4], s[5]},
          .spin = {s[6], s[7], s[8]},
          .squared_speed = s[9],
          .square = Eigen::Matrix3d{{s[10], s[11], s[12]}, {s[11], s[13], s[14]}, {s[12], s[14], s[15]}}};
}

RigidMotion rigid_motion(const RigidSums& sums, const Eigen::Vector3d& near) {
  RigidMotion motion;
  if (sums.count == 0) return motion;
  const Eigen::Vector3d place = sums.place / sums.count;
  motion.center = near + place;
  motion.velocity = sums.velocity / sums.count;
  const Eigen::Vector3d spin = sums.spin - place.cross(sums.velocity);
  const Eigen::Matrix3d square = sums.square - sums.count * place * place.transpose();
  const Eigen::Matrix3d inertia = square.trace() * Eigen::Matrix3d::Identity() - square;
  if (!inertia.allFinite() || !spin.allFinite()) return motion;
  // About an axis without inertia nothing turns.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
  const double least = 1e-9 * axes.eigenvalues().maxCoeff();
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d axis = axes.eigenvectors().col(a);
    if (axes.eigenvalues()[a] > least) motion.spin += axis.dot(spin) / axes.eigenvalues()[a] * axis;
  }
  const double rigid = motion.velocity.squaredNorm() + motion.spin.dot(spin) / sums.count;
  motion.deformation_speed = std::sqrt(std::max(0.0, sums.squared_speed / sums.count - rigid));
  return motion;
}

}  // namespace mallow

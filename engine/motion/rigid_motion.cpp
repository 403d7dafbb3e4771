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

namespace {

/// ω of what has this inertia and spin. About an axis without inertia nothing turns: only where there may be
/// one are the axes looked for, which takes most of what a small body's motion does.
Eigen::Vector3d turning(const Eigen::Matrix3d& inertia, const Eigen::Vector3d& spin) {
  const double mean = inertia.trace() / 3;
  if (inertia.determinant() > 1e-6 * mean * mean * mean) return inertia.inverse() * spin;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
  const double least = 1e-9 * axes.eigenvalues().maxCoeff();
  Eigen::Vector3d turning(0, 0, 0);
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d axis = axes.eigenvectors().col(a);
    if (axes.eigenvalues()[a] > least) turning += axis.dot(spin) / axes.eigenvalues()[a] * axis;
  }
  return turning;
}

}  // namespace

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
  motion.spin = turning(inertia, spin);
  const double rigid = motion.velocity.squaredNorm() + motion.spin.dot(spin) / sums.count;
  motion.deformation_speed = std::sqrt(std::max(0.0, sums.squared_speed / sums.count - rigid));
  return motion;
}

}  // namespace mallow

#include "motion/rigid_motion.h"

#include <Eigen/Eigenvalues>

namespace mallow {

void RigidSums::operator+=(const RigidSums& other) {
  count += other.count;
  place += other.place;
  velocity += other.velocity;
  spin += other.spin;
  squared_speed += other.squared_speed;
  square += other.square;
}

RigidSums sum_rigid(const VectorColumn& positions, const VectorColumn& velocities, std::size_t begin,
                    std::size_t end, const Eigen::Vector3d& near) {
  RigidSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::Vector3d x = positions.get(i).cast<double>() - near, v = velocities.get(i).cast<double>();
    sums.place += x;
    sums.velocity += v;
    sums.spin += x.cross(v);
    sums.squared_speed += v.squaredNorm();
    for (int a = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b) sums.square(a, b) += x[a] * x[b];
  }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b) sums.square(a, b) = sums.square(b, a);
  sums.count = static_cast<double>(end - begin);
  return sums;
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

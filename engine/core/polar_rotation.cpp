#include "core/polar_rotation.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace mallow {
namespace {

/// A says something about every axis where its best rotation beats the next one by this share of A at rest:
/// far above single precision noise in A's sums (1e-6), far below what an honest region has in its weakest
/// direction.
constexpr double k_decided = 1e-3;

/// tr(Rᵀ M) = qᵀ K q for the unit quaternion q = (w, x, y, z) of R.
Eigen::Matrix4d quaternion_matrix(const Eigen::Matrix3d& m) {
  Eigen::Matrix4d k;
  k(0, 0) = m(0, 0) + m(1, 1) + m(2, 2);
  k(0, 1) = m(2, 1) - m(1, 2);
  k(0, 2) = m(0, 2) - m(2, 0);
  k(0, 3) = m(1, 0) - m(0, 1);
  k(1, 1) = m(0, 0) - m(1, 1) - m(2, 2);
  k(1, 2) = m(1, 0) + m(0, 1);
  k(1, 3) = m(2, 0) + m(0, 2);
  k(2, 2) = m(1, 1) - m(0, 0) - m(2, 2);
  k(2, 3) = m(2, 1) + m(1, 2);
  k(3, 3) = m(2, 2) - m(0, 0) - m(1, 1);
  k.triangularView<Eigen::StrictlyLower>() = k.transpose();
  return k;
}

}  // namespace

Eigen::Quaterniond polar_rotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& last, double scale) {
  if (!(scale > 0) || !a.allFinite()) return last;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(quaternion_matrix(a / scale));
  const Eigen::Vector4d remembered(last.w(), last.x(), last.y(), last.z());
  const Eigen::Matrix4d& axes = solver.eigenvectors();
  // Quaternions that are as good as the best one span a space: of one dimension where A decides, of two where it is a
  // line, of four where it is nothing. The last rotation's share of that space is the nearest one to it.
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  for (int k = 0; k < 4; ++k)
    if (solver.eigenvalues()[3] - solver.eigenvalues()[k] < k_decided) q += axes.col(k) * axes.col(k).dot(remembered);
  if (!(q.norm() > k_decided)) q = axes.col(3);
  if (!q.allFinite()) return last;
  Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  rotation.normalize();
  if (rotation.dot(last) < 0) rotation.coeffs() = -rotation.coeffs();
  return rotation;
}

}  // namespace mallow

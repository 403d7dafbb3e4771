#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

namespace mallow::bench {

/// A region's matrix and the rotation it had in the step before.
struct RegionMatrix {
  Eigen::Matrix3f a;  ///< in units of its second moment at rest, which is the identity
  Eigen::Quaternionf last;
};

/// Names of the kinds of matrices that rotations are timed on:
/// small_deformation: singular values within a tenth of 1
/// ratio_10, ratio_100: the largest singular value that many times the smallest, volume kept
/// flat: the smallest is 1e-4; line: only one is above 1e-4
/// mirrored: the smallest has the other sign, by up to nine tenths of the middle one
/// In all of these the region turned by 0.05 rad since the last step.
/// turned: small deformation, turned by 2 rad since the last step.
std::span<const std::string> matrix_kinds();
/// The same matrices at every call.
std::vector<RegionMatrix> make_matrices(const std::string& kind, std::size_t count);

/// The rotation of A's polar decomposition, det +1, from a singular value decomposition in extended
/// precision, and how well it is determined: how much less the second best rotation fits, 2 (s₂ + det s₃), as
/// a share of the trace of the second moment at rest.
struct PolarReference {
  Eigen::Matrix3d rotation;
  double determined;
};
PolarReference polar_reference(const Eigen::Matrix3d& a);

/// How far rotations are from the reference, over the matrices whose rotation is well determined.
struct RotationErrors {
  double median = 0, max = 0;        ///< angle [rad]
  double determined_share = 0;       ///< of the matrices
  double max_determinant_error = 0;  ///< |det R − 1|, over all matrices
};
RotationErrors compare(std::span<const RegionMatrix> matrices, std::span<const Eigen::Matrix3d> rotations);

}  // namespace mallow::bench

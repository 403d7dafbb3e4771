#include "kernels/matrices.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>

#include "harness/statistics.h"

namespace mallow::bench {
namespace {

/// Rotations are held against the reference where it is determined to this share: ten times what the engine
/// takes for nothing (k_decided in core/polar_rotation.cpp).
constexpr double k_well_determined = 1e-2;

const std::vector<std::string> k_kinds = {"small_deformation", "ratio_10", "ratio_100", "flat", "line",
                                          "mirrored",          "turned"};

using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
  // Not std::uniform_real_distribution, whose numbers differ between standard libraries.
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

Eigen::Vector3d direction(Random& random) {
  for (;;) {
    const double x = uniform(random, -1, 1), y = uniform(random, -1, 1), z = uniform(random, -1, 1);
    const Eigen::Vector3d v(x, y, z);
    if (v.squaredNorm() <= 1 && v.squaredNorm() > 0.01) return v.normalized();
  }
}

Eigen::Quaterniond rotation(Random& random) {
  const Eigen::Vector3d axis = direction(random);
  return Eigen::Quaterniond(Eigen::AngleAxisd(uniform(random, -3.1, 3.1), axis));
}

Eigen::Vector3d stretches(const std::string& kind, Random& random) {
  const double a = uniform(random, 0.9, 1.1), b = uniform(random, 0.9, 1.1), c = uniform(random, 0.9, 1.1);
  if (kind == "ratio_10") return {std::sqrt(10.0), b, std::sqrt(0.1)};
  if (kind == "ratio_100") return {10, b, 0.1};
  if (kind == "flat") return {1.4 * a, b, 1e-4};
  if (kind == "line") return {2 * a, 1e-4 * b, 1e-5};
  if (kind == "mirrored") return {1.2 * a, b, -uniform(random, 0.1, 0.9) * b};
  return {a, b, c};
}

double angle(const Eigen::Matrix3d& r) {
  const Eigen::Vector3d twice_sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(twice_sine.norm(), r.trace() - 1);
}

}  // namespace

std::span<const std::string> matrix_kinds() {
  return k_kinds;
}

std::vector<RegionMatrix> make_matrices(const std::string& kind, std::size_t count) {
  Random random(1);
  std::vector<RegionMatrix> matrices;
  matrices.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Quaterniond r = rotation(random);
    const Eigen::Matrix3d axes = rotation(random).toRotationMatrix();
    const Eigen::Vector3d s = stretches(kind, random);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(kind == "turned" ? 2.0 : 0.05, direction(random)));
    // The engine adds the second moment at rest to a sum: an A that it can meet is one rounded after that.
    const Eigen::Matrix3d wanted = r.toRotationMatrix() * axes * s.asDiagonal() * axes.transpose();
    const Eigen::Matrix3f sum = (wanted - Eigen::Matrix3d::Identity()).cast<float>();
    matrices.push_back({Eigen::Matrix3f::Identity() + sum, (r * turn).cast<float>()});
  }
  return matrices;
}

PolarReference polar_reference(const Eigen::Matrix3d& a) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  const Eigen::JacobiSVD<Matrix> svd(a.cast<long double>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix u = svd.matrixU();
  const bool mirrors = u.determinant() * svd.matrixV().determinant() < 0;
  if (mirrors) u.col(2) = -u.col(2);
  const auto middle = static_cast<double>(svd.singularValues()[1]);
  const auto smallest = static_cast<double>(svd.singularValues()[2]);
  return {(u * svd.matrixV().transpose()).cast<double>(),
          2 * (mirrors ? middle - smallest : middle + smallest) / 3};
}

RotationErrors compare(std::span<const RegionMatrix> matrices, std::span<const Eigen::Matrix3d> rotations) {
  RotationErrors errors;
  std::vector<double> angles;
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    const PolarReference reference = polar_reference(matrices[i].a.cast<double>());
    errors.max_determinant_error =
        std::max(errors.max_determinant_error, std::abs(rotations[i].determinant() - 1));
    if (reference.determined < k_well_determined) continue;
    angles.push_back(angle(reference.rotation.transpose() * rotations[i]));
  }
  errors.median = median(angles);
  errors.max = angles.empty() ? 0 : *std::max_element(angles.begin(), angles.end());
  errors.determined_share = static_cast<double>(angles.size()) / static_cast<double>(matrices.size());
  return errors;
}

}  // namespace mallow::bench

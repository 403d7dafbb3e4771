// Rotations of regions, beside a singular value decomposition of Eigen's: how long they take and how far they
// are off.
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <memory>

#include "kernels/kernel_set.h"
#include "kernels/matrices.h"
#include "shape_matching/shape_matching.h"

namespace mallow::bench {
namespace {

constexpr std::size_t k_matrices = 4096;

Json errors_json(std::span<const RegionMatrix> matrices, std::span<const Eigen::Matrix3d> rotations) {
  const RotationErrors errors = compare(matrices, rotations);
  const bool any = errors.determined_share > 0;
  return {{"error_median", any ? Json(errors.median) : Json()},
          {"error_max", any ? Json(errors.max) : Json()},
          {"determined_share", errors.determined_share},
          {"determinant_error_max", errors.max_determinant_error}};
}

/// Regions that own nothing but a matrix: A_j = B_j + sums with B_j = 1, c̄ = 0 and the frame at rest.
struct MatrixRegions {
  std::vector<RegionMatrix> matrices;
  VectorColumn x;  ///< is not read
  ShapeMatching shape;
  MatchedBodies matched;  ///< this one

  explicit MatrixRegions(const std::string& kind) : matrices(make_matrices(kind, k_matrices)), x(k_matrices) {
    shape.reference.resize(k_matrices);
    shape.center.resize(k_matrices);
    shape.region_weight.resize(k_matrices);
    std::fill(shape.region_weight.begin(), shape.region_weight.end(), 1.0f);
    for (std::size_t k = 0; k < 6; ++k) {
      shape.moment[k].resize(k_matrices);
      std::fill(shape.moment[k].begin(), shape.moment[k].end(), k < 3 ? 1.0f : 0.0f);
    }
    for (Column<float>& column : shape.rotation) column.resize(k_matrices);
    shape.sums.resize(k_matrices * k_row);
    shape.undecided.resize(k_matrices);
    restore();
    matched.large.push_back({&shape, 0, {}, shape_input(x, 0, shape)});
    matched.regions.add(k_matrices);
  }
  MatrixRegions(const MatrixRegions&) = delete;
  MatrixRegions& operator=(const MatrixRegions&) = delete;
  /// The sums, and the rotations of the step before.
  void restore() {
    for (std::size_t j = 0; j < k_matrices; ++j) {
      float* const row = shape.sums.data() + j * k_row;
      for (int k = 0; k < 9; ++k) row[k] = matrices[j].a(k / 3, k % 3) - (k % 4 == 0 ? 1.0f : 0.0f);
      for (std::size_t k = 9; k < k_row; ++k) row[k] = 0;
      for (std::size_t k = 0; k < 4; ++k)
        shape.rotation[k][j] = matrices[j].last.coeffs()[static_cast<Eigen::Index>(k)];
    }
  }
  void solve(int threads, InstructionLevel level) {
    solve_rotations(k_enough_iterations, {threads, level}, matched);
  }
  /// As goal positions use them: R − R_g, to which the frame is added here.
  std::vector<Eigen::Matrix3d> rotations() const {
    std::vector<Eigen::Matrix3d> result(k_matrices);
    for (std::size_t j = 0; j < k_matrices; ++j)
      for (int k = 0; k < 9; ++k)
        result[j](k / 3, k % 3) = static_cast<double>(shape.sums[j * k_row + static_cast<std::size_t>(k)]) +
                                  (k % 4 == 0 ? 1.0 : 0.0);
    return result;
  }
};

Timed engine_rotations(const std::string& kind, int threads, InstructionLevel level) {
  const auto regions = std::make_shared<MatrixRegions>(kind);
  regions->solve(threads, level);
  Json about = errors_json(regions->matrices, regions->rotations());
  about["undecided_share"] =
      static_cast<double>(std::count(regions->shape.undecided.begin(), regions->shape.undecided.end(), 1)) /
      static_cast<double>(k_matrices);
  return {.run = [=] { regions->solve(threads, level); },
          .items = static_cast<double>(k_matrices),
          .restore = [=] { regions->restore(); },
          .about = std::move(about)};
}

template <class Scalar>
Eigen::Matrix<Scalar, 3, 3> svd_rotation(const Eigen::Matrix<Scalar, 3, 3>& a) {
  const Eigen::JacobiSVD<Eigen::Matrix<Scalar, 3, 3>> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix<Scalar, 3, 3> u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

template <class Scalar>
Timed eigen_rotations(const std::string& kind) {
  struct Data {
    std::vector<Eigen::Matrix<Scalar, 3, 3>> matrices, rotations;
    void solve() {
      for (std::size_t i = 0; i < matrices.size(); ++i) rotations[i] = svd_rotation<Scalar>(matrices[i]);
    }
  };
  const std::vector<RegionMatrix> matrices = make_matrices(kind, k_matrices);
  const auto data = std::make_shared<Data>();
  for (const RegionMatrix& matrix : matrices) data->matrices.push_back(matrix.a.cast<Scalar>());
  data->rotations.resize(matrices.size());
  data->solve();
  std::vector<Eigen::Matrix3d> rotations;
  for (const auto& rotation : data->rotations) rotations.push_back(rotation.template cast<double>());
  return {.run = [=] { data->solve(); },
          .items = static_cast<double>(matrices.size()),
          .about = errors_json(matrices, rotations)};
}

}  // namespace

void add_rotations(const KernelVariants& variants, KernelSet& set) {
  for (const std::string& kind : matrix_kinds()) {
    for (const int threads : variants.threads)
      for (const InstructionLevel level : variants.levels)
        set.add({"rotations", kind, threads, name(level), "matrix"},
                [=] { return engine_rotations(kind, threads, level); });
    set.add({"eigen_svd_float", kind, 1, "", "matrix"}, [=] { return eigen_rotations<float>(kind); });
    set.add({"eigen_svd_double", kind, 1, "", "matrix"}, [=] { return eigen_rotations<double>(kind); });
  }
}

}  // namespace mallow::bench

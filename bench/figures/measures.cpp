#include "figures/measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace mallow::bench {
namespace {

Eigen::Matrix3Xd columns(std::span<const Vec3> positions) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = positions[i].cast<double>();
  return result;
}

/// Root mean square length of the columns.
template <class Columns>
double root_mean_square(const Columns& x) {
  return std::sqrt(x.squaredNorm() / static_cast<double>(x.cols()));
}

}  // namespace

double height_quantile(std::span<const Vec3> positions, double share) {
  std::vector<float> heights;
  heights.reserve(positions.size());
  for (const Vec3& x : positions) heights.push_back(x.z());
  const auto place = heights.begin() + std::lround(share * static_cast<double>(heights.size() - 1));
  std::nth_element(heights.begin(), place, heights.end());
  return static_cast<double>(*place);
}

double column_height(std::span<const Vec3> positions) {
  const Eigen::RowVectorXd z = columns(positions).row(2);
  return std::sqrt(12.0) * root_mean_square((z.array() - z.mean()).matrix().eval());
}

double horizontal_spread(std::span<const Vec3> positions) {
  const Eigen::Matrix2Xd x = columns(positions).topRows<2>();
  return root_mean_square((x.colwise() - x.rowwise().mean()).eval());
}

double distance_to_rigid_motion(std::span<const Vec3> reference, std::span<const Vec3> positions) {
  const Eigen::Matrix3Xd from = columns(reference), to = columns(positions);
  const Eigen::Isometry3d motion(Eigen::umeyama(from, to, false));
  return root_mean_square((motion * from - to).eval());
}

double unevenness(std::span<const Vec3> positions, double cell) {
  std::map<std::pair<double, double>, double> tops;
  for (const Vec3& x : positions) {
    const Eigen::Vector3d p = x.cast<double>();
    double& top = tops.try_emplace({std::floor(p.x() / cell), std::floor(p.y() / cell)}, p.z()).first->second;
    top = std::max(top, p.z());
  }
  double sum = 0, squares = 0;
  for (const auto& [place, top] : tops) sum += top;
  const double mean = sum / static_cast<double>(tops.size());
  for (const auto& [place, top] : tops) squares += (top - mean) * (top - mean);
  return std::sqrt(squares / static_cast<double>(tops.size()));
}

double lowest(std::span<const double> curve) {
  return *std::min_element(curve.begin(), curve.end());
}

double highest(std::span<const double> curve) {
  return *std::max_element(curve.begin(), curve.end());
}

std::span<const double> last_of(std::span<const double> curve, double share) {
  const auto count =
      std::clamp<long>(std::lround(share * static_cast<double>(curve.size())), 1, std::ssize(curve));
  return curve.last(static_cast<std::size_t>(count));
}

double mean_of_last(std::span<const double> curve, double share) {
  const std::span<const double> last = last_of(curve, share);
  return std::accumulate(last.begin(), last.end(), 0.0) / static_cast<double>(last.size());
}

}  // namespace mallow::bench

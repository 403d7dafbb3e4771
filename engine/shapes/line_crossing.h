#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>

namespace mallow {

/// Where a triangle meets a line parallel to x.
struct LineCrossing {
  double x;  ///< within the triangle's extent in x
  int turn;  ///< +1 where the triangle, counter-clockwise from outside, faces +x, −1 where it faces −x
};

/// The crossing of a triangle with the line through (y, z) parallel to x, if there is one. An edge that two
/// triangles share is decided by the same numbers for both, and edges and corners that the line hits belong
/// to one side of it: along any line the turns of a closed, oriented surface add up to 0 exactly, and those
/// to the right of a point are its winding number.
inline std::optional<LineCrossing> cross_line(const std::array<Eigen::Vector3d, 3>& corners, double y,
                                              double z) {
  int turn = 0;
  std::array<double, 2> edge_y{},
      edge_x{};  // where the edge that goes up in z, and the one that goes down, are
  bool any = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d &a = corners[k], &b = corners[(k + 1) % 3];
    const bool up = a.z() <= z && b.z() > z;
    if (!up && !(b.z() <= z && a.z() > z)) continue;
    any = true;
    const Eigen::Vector3d &low = up ? a : b, &high = up ? b : a;
    const double share = (z - low.z()) / (high.z() - low.z());
    const std::size_t side = up ? 0 : 1;
    edge_y[side] = low.y() + share * (high.y() - low.y());
    edge_x[side] = low.x() + share * (high.x() - low.x());
    if (edge_y[side] > y) turn += up ? 1 : -1;
  }
  if (!any || turn == 0) return std::nullopt;
  const double share = std::clamp((y - edge_y[0]) / (edge_y[1] - edge_y[0]), 0.0, 1.0);
  return LineCrossing{edge_x[0] + share * (edge_x[1] - edge_x[0]), turn};
}

}  // namespace mallow

#include "kernels/lattice.h"

#include <Eigen/Geometry>

#include "mallow/body.h"
#include "neighbors/cell_grid.h"

namespace mallow::bench {

VectorColumn reordered(const VectorColumn& points, std::span<const std::uint32_t> order) {
  VectorColumn result(points.size());
  for (std::size_t k = 0; k < order.size(); ++k) result.set(k, points.get(order[k]));
  return result;
}

VectorColumn lattice_points(const LatticeScene& scene, float jitter) {
  const Body body = sample(Lattice{.count = scene.count, .spacing = scene.spacing, .jitter = jitter});
  VectorColumn points(body.positions.size());
  for (std::size_t i = 0; i < points.size(); ++i) points.set(i, body.positions[i]);
  CellGrid grid;
  build_cell_grid(points, 0, points.size(), scene.radius, {1, best_instruction_level()}, grid);
  return reordered(points, grid.order.span());
}

VectorColumn bent(const VectorColumn& points) {
  VectorColumn result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 x = points.get(i);
    const Vec3 twisted = Eigen::AngleAxisf(0.02f * x.z(), Vec3::UnitZ()) * x;
    result.set(i, Eigen::AngleAxisf(0.01f * twisted.x(), Vec3::UnitX()) * twisted);
  }
  return result;
}

}  // namespace mallow::bench

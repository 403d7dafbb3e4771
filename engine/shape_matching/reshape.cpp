#include "shape_matching/reshape.h"

#include <limits>
#include <optional>

#include "neighbors/neighbor_lists.h"

namespace mallow {
namespace {

/// Sums of the reference shape are taken about its mean, which what came or went has moved.
void center_reference(ShapeMatching& shape) {
  VectorColumn& reference = shape.reference;
  const auto n = static_cast<double>(reference.size());
  shape.total_moment = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    float* const x = reference.axis(a);
    double sum = 0;
    for (std::size_t i = 0; i < reference.size(); ++i) sum += static_cast<double>(x[i]);
    for (std::size_t i = 0; i < reference.size(); ++i) {
      const double centered = static_cast<double>(x[i]) - sum / n;
      x[i] = static_cast<float>(centered);
      shape.total_moment += centered * centered / n;
    }
  }
  shape.built = false;
}

Eigen::Quaternionf turn(const Eigen::Vector4f& rotation) {
  return Eigen::Quaternionf(rotation);
}

/// Per added point the nearest particle of the body within the region radius, if there is one.
std::vector<std::optional<std::size_t>> nearest_of_body(const VectorColumn& positions, std::size_t begin,
                                                        std::span<const Vec3> added,
                                                        const Execution& execution,
                                                        const ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  VectorColumn points(n + added.size());
  for (std::size_t i = 0; i < n; ++i) points.set(i, positions.get(begin + i));
  for (std::size_t k = 0; k < added.size(); ++k) points.set(n + k, added[k]);
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(points, 0, points.size(), shape.region_radius, execution, grid);
  build_neighbor_lists(grid, shape.region_radius, execution, lists);
  std::vector<std::optional<std::size_t>> nearest(added.size());
  for (std::size_t s = 0; s < points.size(); ++s) {
    const std::size_t own = grid.order[s];
    if (own < n) continue;
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t t : lists.of(s)) {
      const std::size_t other = grid.order[t];
      const float distance = (points.get(own) - points.get(other)).squaredNorm();
      // Of several as near the first, so that the order of a list does not matter.
      if (other >= n || distance > least || (distance == least && other > *nearest[own - n])) continue;
      least = distance;
      nearest[own - n] = other;
    }
  }
  return nearest;
}

}  // namespace

std::vector<Eigen::Vector4f> particle_rotations(const ShapeMatching& shape) {
  std::vector<Eigen::Vector4f> rotations(shape.reference.size());
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const std::size_t region = shape.first_region(i);
    for (std::size_t k = 0; k < 4; ++k)
      rotations[i][static_cast<Eigen::Index>(k)] = shape.rotation[k][region];
  }
  return rotations;
}

void build_regions_from(std::span<const Eigen::Vector4f> rotations, const Execution& execution,
                        RegionScratch& scratch, ShapeMatching& shape) {
  build_regions(execution, scratch, shape);
  for (std::size_t j = 0; j < shape.region_weight.size(); ++j)
    for (std::size_t k = 0; k < 4; ++k)
      shape.rotation[k][j] = rotations[shape.first_row(j)][static_cast<Eigen::Index>(k)];
}

void erase_from_reference(std::span<const std::uint32_t> places, ShapeMatching& shape) {
  shape.reference.erase(places);
  center_reference(shape);
}

void append_to_reference(const VectorColumn& positions, std::size_t begin, std::span<const Vec3> added,
                         const Execution& execution, std::vector<Eigen::Vector4f>& rotations,
                         ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  const auto nearest = nearest_of_body(positions, begin, added, execution, shape);
  Eigen::Vector3d middle(0, 0, 0);
  for (std::size_t i = 0; i < n; ++i)
    middle += positions.get(begin + i).cast<double>() / static_cast<double>(n);
  const Eigen::Vector4f whole = shape.frame.rotation.coeffs().cast<float>();
  shape.reference.resize(n + added.size());
  for (std::size_t k = 0; k < added.size(); ++k) {
    const std::optional<std::size_t> beside = nearest[k];
    const Eigen::Vector4f rotation = beside ? rotations[*beside] : whole;
    const Vec3 from = beside ? positions.get(begin + *beside) : Vec3(middle.cast<float>());
    const Vec3 rest = beside ? shape.reference.get(*beside) : Vec3(0, 0, 0);
    shape.reference.set(n + k, rest + turn(rotation).conjugate() * (added[k] - from));
    rotations.push_back(rotation);
  }
  center_reference(shape);
}

}  // namespace mallow

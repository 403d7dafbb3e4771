#include "level_set/winding_signs.h"

#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shapes/line_crossing.h"

namespace mallow {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int k_side = static_cast<int>(Leaf::DIM);

/// Lines of voxels along x, in layers one leaf of the tree thick along z.
class Lines {
 public:
  Lines(const Orientation& mesh, const std::vector<openvdb::Vec3s>& points, openvdb::FloatGrid& grid)
      : mesh_(mesh), points_(points) {
    grid.tree().getNodes(leaves_);
    openvdb::CoordBBox box;
    for (const Leaf* leaf : leaves_) box.expand(leaf->getNodeBoundingBox());
    min_ = box.min();
    for (std::size_t axis = 0; axis < 3; ++axis) count_[axis] = static_cast<std::size_t>(box.dim()[axis]);
    sort_into_layers();
  }

  std::size_t layers() const { return leaf_begin_.size() - 1; }

  /// Signs the voxels of a layer.
  WindingSummary sign(std::size_t layer) const {
    WindingSummary summary;
    std::vector<int> winding(count_[1] * count_[0]);
    for (int k = 0; k < k_side; ++k) {
      const int z = min_.z() + static_cast<int>(layer) * k_side + k;
      find_winding(layer, z, winding);
      for (const int w : winding) {
        summary.inside += is_inside(w);
        summary.highest = std::max(summary.highest, w);
        summary.lowest = std::min(summary.lowest, w);
      }
      for (std::size_t l = leaf_begin_[layer]; l < leaf_begin_[layer + 1]; ++l) sign(*leaves_[l], z, winding);
    }
    return summary;
  }

 private:
  bool is_inside(int winding) const { return mesh_.even_odd ? winding % 2 != 0 : winding > 0; }

  std::size_t layer_of(double z) const {
    const double layer = std::floor((z - min_.z()) / k_side);
    return static_cast<std::size_t>(std::clamp(layer, 0.0, static_cast<double>(count_[2] / k_side - 1)));
  }

  /// The layers that a triangle reaches.
  std::pair<std::size_t, std::size_t> layers_of(std::size_t t) const {
    const auto [a, b, c] = mesh_.triangles[t];
    const auto [low, high] = std::minmax({points_[a].z(), points_[b].z(), points_[c].z()});
    return {layer_of(low), layer_of(high)};
  }

  void sort_into_layers() {
    std::stable_sort(leaves_.begin(), leaves_.end(),
                     [](const Leaf* a, const Leaf* b) { return a->origin().z() < b->origin().z(); });
    const std::size_t layers = count_[2] / k_side;
    leaf_begin_.assign(layers + 1, 0);
    for (const Leaf* leaf : leaves_) ++leaf_begin_[layer_of(leaf->origin().z()) + 1];
    triangle_begin_.assign(layers + 1, 0);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto [first, last] = layers_of(t);
      for (std::size_t layer = first; layer <= last; ++layer) ++triangle_begin_[layer + 1];
    }
    for (std::size_t layer = 0; layer < layers; ++layer) {
      leaf_begin_[layer + 1] += leaf_begin_[layer];
      triangle_begin_[layer + 1] += triangle_begin_[layer];
    }
    triangles_.resize(triangle_begin_.back());
    std::vector<std::size_t> next(triangle_begin_.begin(), triangle_begin_.end() - 1);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto [first, last] = layers_of(t);
      for (std::size_t layer = first; layer <= last; ++layer)
        triangles_[next[layer]++] = static_cast<std::uint32_t>(t);
    }
  }

  /// Winding numbers of the voxels at z, x fastest.
  void find_winding(std::size_t layer, int z, std::vector<int>& winding) const {
    std::fill(winding.begin(), winding.end(), 0);
    for (std::size_t i = triangle_begin_[layer]; i < triangle_begin_[layer + 1]; ++i) {
      std::array<Eigen::Vector3d, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const openvdb::Vec3s& p = points_[mesh_.triangles[triangles_[i]][k]];
        corners[k] = {p.x(), p.y(), p.z()};
      }
      const auto [low_z, high_z] = std::minmax({corners[0].z(), corners[1].z(), corners[2].z()});
      if (low_z > z || high_z <= z) continue;
      const auto [low_y, high_y] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
      const int last_y = static_cast<int>(std::floor(high_y));
      for (int y = static_cast<int>(std::ceil(low_y)); y <= last_y; ++y) {
        const auto crossing = cross_line(corners, y, z);
        if (!crossing) continue;
        // It counts for all voxels to the left of it; for now it stands at the last of them.
        const auto last = static_cast<std::size_t>(std::ceil(crossing->x) - 1 - min_.x());
        winding[line(y) + last] += mesh_.even_odd ? std::abs(crossing->turn) : crossing->turn;
      }
    }
    for (std::size_t begin = 0; begin < winding.size(); begin += count_[0])
      for (std::size_t x = count_[0] - 1; x > 0; --x) winding[begin + x - 1] += winding[begin + x];
  }

  std::size_t line(int y) const { return static_cast<std::size_t>(y - min_.y()) * count_[0]; }

  void sign(Leaf& leaf, int z, const std::vector<int>& winding) const {
    const openvdb::Coord origin = leaf.origin();
    for (int x = 0; x < k_side; ++x) {
      for (int y = 0; y < k_side; ++y) {
        const openvdb::Index offset = Leaf::coordToOffset({origin.x() + x, origin.y() + y, z});
        if (is_inside(winding[line(origin.y() + y) + static_cast<std::size_t>(origin.x() + x - min_.x())]))
          leaf.setValueOnly(offset, -leaf.getValue(offset));
      }
    }
  }

  const Orientation& mesh_;
  const std::vector<openvdb::Vec3s>& points_;
  std::vector<Leaf*> leaves_ = {};  ///< by layer
  openvdb::Coord min_ = {};         ///< first voxel of all leaves
  std::array<std::size_t, 3> count_{};
  std::vector<std::size_t> leaf_begin_ = {}, triangle_begin_ = {};
  std::vector<std::uint32_t> triangles_ = {};  ///< by layer, those that reach it
};

}  // namespace

WindingSummary sign_by_winding(const Orientation& mesh, const std::vector<openvdb::Vec3s>& points,
                               openvdb::FloatGrid& grid) {
  const Lines lines(mesh, points, grid);
  std::vector<WindingSummary> partial(lines.layers());
  tbb::parallel_for(std::size_t{0}, lines.layers(),
                    [&](std::size_t layer) { partial[layer] = lines.sign(layer); });
  openvdb::tools::signedFloodFill(grid.tree());
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
  WindingSummary summary;
  for (const WindingSummary& part : partial) {
    summary.inside += part.inside;
    summary.highest = std::max(summary.highest, part.highest);
    summary.lowest = std::min(summary.lowest, part.lowest);
  }
  return summary;
}

}  // namespace mallow

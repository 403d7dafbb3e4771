// The surface around particles of Zhu & Bridson 2005, "Animating sand as a fluid", section 5:
//   φ(x) = |x − x̄| − r,   x̄ = Σ w_i x_i / Σ w_i,   w_i = max(0, 1 − |x − x_i|²/R²)³
// symbol | here           | unit
// x_i    | x, y, z        | offsets from the leaf's first voxel, here divided by R
// R      | 1              | kernel radius
// r      | offset + ...   | grows with the weight, see SurfaceShape::extra_offset
// Departs: |x − x̄|² grows by half of what the variance Σ w_i |x_i − x̄|² / Σ w_i is above that of one part of
// a body. Between two parts x̄ jumps from one to the other and passes x on its way, which would make φ
// negative in the empty middle. Solenthaler et al. 2007 see that in the eigenvalues of ∇x̄, ten sums more; the
// variance is one sum more. The distance to the nearest particle tells it less well: it ripples, and leaves
// crumbs in gaps of two spacings.
#include "level_set/surface_kernel.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// A row of voxels along z: the compiler maps it to what the level's registers are.
using Row = float __attribute__((vector_size(k_leaf_side * sizeof(float))));

struct RowSums {
  Row weight{}, x{}, y{}, z{}, distance2{};
};

/// Particles within the kernel radius of a plane of rows.
struct PlaneParticles {
  float *x, *y, *z;
  std::size_t count;
};

RowSums sum_row(const PlaneParticles& near, float row_x, float row_y, const Row& row_z) noexcept {
  RowSums sums;
  for (std::size_t p = 0; p < near.count; ++p) {
    const float dx = near.x[p] - row_x, dy = near.y[p] - row_y;
    const Row dz = near.z[p] - row_z;
    const Row distance2 = dz * dz + (dx * dx + dy * dy);
    const Row t = distance2 < 1.0f ? 1.0f - distance2 : Row{};
    const Row w = t * t * t;
    sums.weight += w;
    sums.x += w * dx;
    sums.y += w * dy;
    sums.z += w * dz;
    sums.distance2 += w * distance2;
  }
  return sums;
}

float distance_at(const SurfaceShape& shape, float weight, float x, float y, float z,
                  float distance2) noexcept {
  if (!(weight > 0)) return shape.background;
  const float double_fullness = 2.0f * weight / shape.full_weight;
  const float full = double_fullness < 1.0f ? double_fullness : 1.0f;
  const float mx = x / weight, my = y / weight, mz = z / weight;
  const float from_mean2 = mx * mx + my * my + mz * mz;
  const float excess = distance2 / weight - from_mean2 - (shape.spread + shape.extra_spread * full);
  const float r = shape.offset + shape.extra_offset * full;
  const float distance =
      (__builtin_sqrtf(from_mean2 + (excess > 0 ? k_excess_share * excess : 0)) - r) / shape.voxel_size;
  if (distance > shape.background) return shape.background;
  return distance < -shape.background ? -shape.background : distance;
}

/// A leaf's particles, and those of them that reach the plane of rows at hand.
class LeafRows {
 public:
  LeafRows(const SurfaceShape& shape, const float* x, const float* y, const float* z, std::size_t count,
           float* scratch) noexcept
      : shape_(shape),
        x_(x),
        y_(y),
        z_(z),
        count_(count),
        near_{scratch, scratch + count, scratch + 2 * count, 0} {
    for (int k = 0; k < k_leaf_side; ++k) row_z_[k] = static_cast<float>(k) * shape.voxel_size;
  }

  void select_plane(int i) noexcept {
    row_x_ = static_cast<float>(i) * shape_.voxel_size;
    near_.count = 0;
    for (std::size_t p = 0; p < count_; ++p) {
      // Always written, kept only if near: no branch to predict.
      const float px = x_[p] * shape_.voxel_size;
      near_.x[near_.count] = px;
      near_.y[near_.count] = y_[p] * shape_.voxel_size;
      near_.z[near_.count] = z_[p] * shape_.voxel_size;
      near_.count += (px - row_x_) * (px - row_x_) < 1.0f;
    }
  }

  void fill_row(int j, float* distances) const noexcept {
    const RowSums sums = sum_row(near_, row_x_, static_cast<float>(j) * shape_.voxel_size, row_z_);
    for (int k = 0; k < k_leaf_side; ++k)
      distances[k] = distance_at(shape_, sums.weight[k], sums.x[k], sums.y[k], sums.z[k], sums.distance2[k]);
  }

 private:
  const SurfaceShape& shape_;
  const float *x_, *y_, *z_;
  std::size_t count_;
  PlaneParticles near_;
  float row_x_ = 0;
  Row row_z_;
};

constexpr int k_probed_rows[] = {0, k_leaf_side / 2, k_leaf_side - 1};

/// Looks at nine of the 64 rows. A face cannot cut the leaf and miss its corners, and the rows are closer
/// than the spheres of lone particles are wide.
LeafContent probe_leaf(const SurfaceShape& shape, LeafRows& rows) noexcept {
  const float deep = -0.5f * shape.offset / shape.voxel_size;
  bool outside = true, inside = true;
  for (const int i : k_probed_rows) {
    rows.select_plane(i);
    for (const int j : k_probed_rows) {
      float distances[k_leaf_side];
      rows.fill_row(j, distances);
      for (const float distance : distances) {
        outside = outside && distance >= shape.background;
        inside = inside && distance <= deep;
      }
      if (!outside && !inside) return LeafContent::surface;
    }
  }
  return outside ? LeafContent::outside : LeafContent::inside;
}

LeafContent fill_leaf(const SurfaceShape& shape, const float* x, const float* y, const float* z,
                      std::size_t count, float* scratch, float* distances) noexcept {
  LeafRows rows(shape, x, y, z, count, scratch);
  if (shape.probe) {
    const LeafContent content = probe_leaf(shape, rows);
    if (content != LeafContent::surface) return content;
  }
  for (int i = 0; i < k_leaf_side; ++i) {
    rows.select_plane(i);
    for (int j = 0; j < k_leaf_side; ++j) rows.fill_row(j, distances + (i * k_leaf_side + j) * k_leaf_side);
  }
  return LeafContent::surface;
}

}  // namespace

extern const SurfaceKernels surface_kernels;
const SurfaceKernels surface_kernels = {fill_leaf};

}  // namespace mallow::MALLOW_LEVEL

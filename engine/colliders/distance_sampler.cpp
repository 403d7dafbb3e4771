// Implicit shapes as grids of distances. Where only a band around the surface is known, the rest follows from
// it by fast sweeping of |∇d| = 1 [Zhao 2005].
#include <algorithm>
#include <cmath>
#include <string>

#include "core/checks.h"
#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

/// Voxels between the box of a shape and the sides of its grid: an eighth of its longest side, so that where
/// particles touch it, half a spacing away, is within the grid. Beside it distances are a bound, and a shape
/// whose voxels are much finer than the particles held them off by a fifth of a spacing.
constexpr int k_widest_margin = 16;
int margin(double longest) {
  return static_cast<int>(std::ceil(std::clamp(longest / 8, 3.0, double{k_widest_margin})));
}
/// What sweeping adds to the band is a little too long; it must not be, as particles rely on it.
constexpr float k_trusted = 0.9f;

/// One sweep over a grid of unsigned distances in voxels, in one of the eight orders.
class Sweep {
 public:
  Sweep(const std::array<int, 3>& size, const std::vector<bool>& known, std::vector<float>& distance)
      : size_(size), known_(known), distance_(distance) {}

  void run(int order) {
    const auto place = [&](int k, std::size_t axis) {
      return (order >> axis & 1) != 0 ? size_[axis] - 1 - k : k;
    };
    for (int z = 0; z < size_[2]; ++z)
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x) update(place(x, 0), place(y, 1), place(z, 2));
  }

 private:
  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(size_[0]) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(z));
  }
  float lesser(int x, int y, int z, int axis) const {
    int at[3] = {x, y, z};
    float least = std::numeric_limits<float>::infinity();
    for (const int step : {-1, 1}) {
      int next[3] = {x, y, z};
      next[axis] = at[axis] + step;
      if (next[axis] < 0 || next[axis] >= size_[static_cast<std::size_t>(axis)]) continue;
      least = std::min(least, distance_[index(next[0], next[1], next[2])]);
    }
    return least;
  }
  /// The upwind solution of |∇d| = 1 from one, two or three axes.
  void update(int x, int y, int z) {
    const std::size_t i = index(x, y, z);
    if (known_[i]) return;
    float a[3] = {lesser(x, y, z, 0), lesser(x, y, z, 1), lesser(x, y, z, 2)};
    std::sort(a, a + 3);
    if (!std::isfinite(a[0])) return;
    float d = a[0] + 1;
    if (d > a[1]) {
      const float gap = a[1] - a[0];
      d = 0.5f * (a[0] + a[1] + std::sqrt(std::max(0.0f, 2 - gap * gap)));
      if (d > a[2]) {
        const float sum = a[0] + a[1] + a[2];
        const float squares = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        d = (sum + std::sqrt(std::max(0.0f, sum * sum - 3 * (squares - 1)))) / 3;
      }
    }
    distance_[i] = std::min(distance_[i], d);
  }

  const std::array<int, 3>& size_;
  const std::vector<bool>& known_;
  std::vector<float>& distance_;
};

void fill_beyond(float band, DistanceGrid& grid) {
  std::vector<bool> known(grid.distances.size());
  std::vector<float> far(grid.distances.size());
  bool any = false;
  for (std::size_t i = 0; i < far.size(); ++i) {
    known[i] = std::abs(grid.distances[i]) < band;
    any = any || known[i];
    far[i] =
        known[i] ? std::abs(grid.distances[i]) / grid.voxel_size : std::numeric_limits<float>::infinity();
  }
  if (!any) return;
  Sweep sweep(grid.size, known, far);
  for (int round = 0; round < 2; ++round)
    for (int order = 0; order < 8; ++order) sweep.run(order);
  for (std::size_t i = 0; i < far.size(); ++i) {
    if (known[i]) continue;
    const float more = std::max(0.0f, far[i] * grid.voxel_size - band);
    grid.distances[i] = std::copysign(band + k_trusted * more, grid.distances[i]);
  }
}

}  // namespace

DistanceField distance_field(const ImplicitShape& shape, float voxel_size, bool inside, float band) {
  Checks checks;
  checks.number("voxel_size", voxel_size, voxel_size > 0, "a number > 0");
  if (!(band > 0)) checks.problem("band", "must be above 0");
  checks.finish();
  auto grid = std::make_shared<DistanceGrid>();
  grid->voxel_size = voxel_size;
  const Eigen::Array3d voxels =
      ((shape.bounds.max - shape.bounds.min).cast<double>() / static_cast<double>(voxel_size)).array().ceil();
  constexpr int k_most_voxels = k_most_grid_points - 2 * k_widest_margin - 1;
  if (!(voxels <= k_most_voxels).all())
    throw ConfigError("voxel_size", "is too small: the shape has more than " + std::to_string(k_most_voxels) +
                                        " voxels along an axis");
  const int beside = margin(voxels.maxCoeff());
  grid->origin = shape.bounds.min - Vec3::Constant(static_cast<float>(beside) * voxel_size);
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    grid->size[static_cast<std::size_t>(axis)] = static_cast<int>(voxels[axis]) + 2 * beside + 1;
    count *= static_cast<std::size_t>(grid->size[static_cast<std::size_t>(axis)]);
  }
  grid->distances.reserve(count);
  for (int z = 0; z < grid->size[2]; ++z)
    for (int y = 0; y < grid->size[1]; ++y)
      for (int x = 0; x < grid->size[0]; ++x)
        grid->distances.push_back(
            shape.distance(grid->origin + voxel_size * Vec3(static_cast<float>(x), static_cast<float>(y),
                                                            static_cast<float>(z))));
  if (std::isfinite(band)) fill_beyond(band, *grid);
  return {std::move(grid), inside};
}

}  // namespace mallow

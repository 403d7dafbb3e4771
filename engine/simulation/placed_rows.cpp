#include "simulation/placed_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "core/bounds.h"

namespace mallow {
namespace {

/// Times that all rows are looked at before a table is made of them, which takes about as long.
constexpr std::size_t k_looks = 16;
constexpr std::uint32_t k_none = UINT32_MAX;

std::vector<std::uint32_t> rows_in(const VectorColumn& positions, const Aabb& box) {
  const float *x = positions.x(), *y = positions.y(), *z = positions.z();
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (x[i] >= box.min.x() && x[i] <= box.max.x() && y[i] >= box.min.y() && y[i] <= box.max.y() &&
        z[i] >= box.min.z() && z[i] <= box.max.z())
      rows.push_back(static_cast<std::uint32_t>(i));
  return rows;
}

}  // namespace

void PlacedRows::forget() {
  *this = {};
}

std::int64_t PlacedRows::cell(float x) const {
  constexpr double k_most = 1e15;  // cells beyond are one
  return static_cast<std::int64_t>(
      std::floor(std::clamp(static_cast<double>(x) / static_cast<double>(edge_), -k_most, k_most)));
}

std::size_t PlacedRows::bucket(std::int64_t x, std::int64_t y, std::int64_t z) const {
  // Cells in a row are in no row of buckets, so that lattices fill them evenly.
  const std::uint64_t mixed = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u ^
                              static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu ^
                              static_cast<std::uint64_t>(z) * 0x165667B19E3779F9u;
  return static_cast<std::size_t>((mixed ^ (mixed >> 32)) * 0x9E3779B97F4A7C15u >> 32) & (first_.size() - 1);
}

void PlacedRows::put(const VectorColumn& positions, std::size_t row) {
  const Vec3 x = positions.get(row);
  std::uint32_t& first = first_[bucket(cell(x[0]), cell(x[1]), cell(x[2]))];
  next_.push_back(first);
  first = static_cast<std::uint32_t>(row);
}

void PlacedRows::build(const VectorColumn& positions, float spacing) {
  edge_ = spacing;
  first_.assign(std::bit_ceil(4 * positions.size()), k_none);
  next_.clear();
  for (std::size_t row = 0; row < positions.size(); ++row) put(positions, row);
}

void PlacedRows::extend(const VectorColumn& positions) {
  if (!is_built()) return;
  if (2 * positions.size() > first_.size()) return build(positions, edge_);
  for (std::size_t row = next_.size(); row < positions.size(); ++row) put(positions, row);
}

std::vector<std::uint32_t> PlacedRows::near(const VectorColumn& positions, std::int64_t step, float spacing,
                                            std::span<const Vec3> points, float reach) {
  if (step != step_) forget();
  step_ = step;
  Aabb box = {points.front(), points.front()};
  for (const Vec3& x : points) box = box_around(box, {x, x});
  box.min.array() -= reach;
  box.max.array() += reach;
  if (!is_built()) {
    seen_ += positions.size();
    if (seen_ <= k_looks * positions.size()) return rows_in(positions, box);
    build(positions, spacing);
  }
  const double cells = std::pow(2 * std::ceil(static_cast<double>(reach / edge_)) + 1, 3);
  if (cells * static_cast<double>(points.size()) > static_cast<double>(positions.size()))
    return rows_in(positions, box);
  std::vector<std::uint32_t> rows;
  for (const Vec3& x : points) {
    const Vec3 low = x.array() - reach, high = x.array() + reach;
    for (std::int64_t k = cell(low[2]); k <= cell(high[2]); ++k)
      for (std::int64_t j = cell(low[1]); j <= cell(high[1]); ++j)
        for (std::int64_t i = cell(low[0]); i <= cell(high[0]); ++i)
          for (std::uint32_t row = first_[bucket(i, j, k)]; row != k_none; row = next_[row])
            if (is_near(positions.get(row), {x, x}, reach)) rows.push_back(row);
  }
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace mallow

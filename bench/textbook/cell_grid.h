#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "textbook/particle.h"

namespace mallow::textbook {

/// Finds the points within a radius with a uniform grid of cells, of which only those that hold points exist.
class CellGrid {
 public:
  explicit CellGrid(double radius)
      // A hair wider than the radius, so that rounding puts no neighbour two cells away.
      : cell_size_(radius * (1 + 1e-9)), squared_radius_(radius * radius) {}

  void insert(std::size_t index, const Vec& x) { cells_[key(cell_of(x))].push_back({index, x}); }

  /// Calls f(index) for every point within the radius of x.
  template <class F>
  void for_each_near(const Vec& x, const F& f) const {
    const Cell center = cell_of(x);
    for (std::int64_t dz = -1; dz <= 1; ++dz) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dx = -1; dx <= 1; ++dx) {
          const auto cell = cells_.find(key({center.x + dx, center.y + dy, center.z + dz}));
          if (cell == cells_.end()) continue;
          for (const Point& point : cell->second) {
            if ((point.x - x).squaredNorm() <= squared_radius_) f(point.index);
          }
        }
      }
    }
  }

 private:
  struct Cell {
    std::int64_t x, y, z;
  };
  struct Point {
    std::size_t index;
    Vec x;
  };

  Cell cell_of(const Vec& x) const {
    const auto along = [&](int axis) { return static_cast<std::int64_t>(std::floor(x[axis] / cell_size_)); };
    return {along(0), along(1), along(2)};
  }
  /// 21 bits an axis. Cells that share a key are 2^21 cells apart, and the distance tells their points apart.
  static std::uint64_t key(const Cell& cell) {
    const auto bits = [](std::int64_t i) { return static_cast<std::uint64_t>(i) & ((1u << 21) - 1); };
    return bits(cell.x) | bits(cell.y) << 21 | bits(cell.z) << 42;
  }

  double cell_size_;
  double squared_radius_;
  std::unordered_map<std::uint64_t, std::vector<Point>> cells_;
};

}  // namespace mallow::textbook

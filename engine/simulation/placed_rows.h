#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"

namespace mallow {

/// Where the rows of a store are, while bodies come one after the other: each looks only at what is beside
/// it, so that a thousand bodies cost a thousand times what one does. Nothing is kept, and all rows are
/// looked at, until that has cost more than a table does.
class PlacedRows {
 public:
  /// Rows within `reach` of one of the points along every axis, ascending; and others, perhaps, of the box
  /// around the points. step: of the simulation, as rows move in every one. spacing: of the rows, about [m].
  std::vector<std::uint32_t> near(const VectorColumn& positions, std::int64_t step, float spacing,
                                  std::span<const Vec3> points, float reach);
  /// Rows have come behind all others, which are where they were.
  void extend(const VectorColumn& positions);
  /// Rows have changed or moved.
  void forget();

 private:
  bool is_built() const { return !first_.empty(); }
  void build(const VectorColumn& positions, float spacing);
  std::int64_t cell(float x) const;
  std::size_t bucket(std::int64_t x, std::int64_t y, std::int64_t z) const;
  void put(const VectorColumn& positions, std::size_t row);

  float edge_ = 0;         ///< of a cell [m]
  std::int64_t step_ = 0;  ///< what is known is known of this one
  std::size_t seen_ = 0;   ///< rows that calls have looked at, all of them each time
  // A list of rows for each bucket of cells; those of several cells may be in one.
  std::vector<std::uint32_t> first_, next_;
};

}  // namespace mallow

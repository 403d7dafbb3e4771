#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "shape_matching/shape_kernels.h"

namespace mallow {

/// Points sorted as ColumnOrder sorts them, by their places along the columns and across.
struct ReachInput {
  const float* along;
  const float* across[2];
  float squared_radius;
};

/// What of a column may be in reach of a point: sorted points [first, end), none of which is in reach where
/// it is farther along than `reach`.
struct ReachColumn {
  std::uint32_t first, end;
  float reach;  ///< [m]
};

struct ReachKernels {
  /// Writes the runs of sorted points in these columns that are within the radius of sorted point s,
  /// ascending and apart from each other; returns how many. Moves the columns' `first` behind what is out of
  /// reach of s and of all points farther along than it. runs: room for half as many as columns and points
  /// together, and one. members: becomes how many points the runs hold.
  std::size_t (*runs_in_reach)(const ReachInput&, std::size_t s, ReachColumn* columns, std::size_t count,
                               Run* runs, std::uint32_t& members) noexcept;
};
MALLOW_DECLARE_LEVELS(ReachKernels, reach_kernels)

}  // namespace mallow

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "shape_matching/shape_lanes.h"

namespace mallow {

/// Doubles of a row of moments: weight, first and second moments, and padding to whole registers.
inline constexpr std::size_t k_moment_row = 12;

struct MomentLanes {
  /// Σ (x_i − o) x̄_iᵀ (row by row), Σ (x_i − o) of particles [begin, end).
  void (*frame_sums)(ConstVectors position, ConstVectors reference, const double* origin, std::size_t begin,
                     std::size_t end, double* sums) noexcept;
  /// Row i: w_i (1, x̄, x̄ x̄ᵀ). rows: on a 32-byte boundary.
  void (*write_rows)(ConstVectors reference, const float* weight, std::size_t begin, std::size_t end,
                     double* rows) noexcept;
  /// sum: of the rows in the runs.
  void (*sum_runs)(const double* rows, const Run* runs, std::size_t count, double* sum) noexcept;
};
MALLOW_DECLARE_LEVELS(MomentLanes, moment_lanes)

}  // namespace mallow

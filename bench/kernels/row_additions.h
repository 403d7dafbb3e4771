#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// How fast a machine adds rows of 64 bytes that lie one behind the other: what region sums, which look their
/// rows up in lists, are measured against.
struct RowAdditions {
  /// sum: 16 floats, the sum of `count` rows of 16 floats on 64-byte boundaries.
  void (*add)(const float* rows, std::size_t count, float* sum) noexcept;
};
MALLOW_DECLARE_LEVELS(RowAdditions, row_additions)

}  // namespace mallow

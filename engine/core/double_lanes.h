#pragma once

// Sums in double over rows of float columns, for files of lanes.
#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Lanes of a sum: as many at every level, which takes them a register at a time. Wider than a register GCC
/// 12 keeps them in memory, at five times the cost.
constexpr std::size_t k_sum_lanes = 8;
constexpr std::size_t k_doubles = k_width / 2;
using Doubles = VectorOf<double, k_doubles>;

inline Doubles load_doubles(const float* values) {
  VectorOf<float, k_doubles> floats;
  copy_bytes(&floats, values, sizeof floats);
  return converted<Doubles>(floats);
}

/// sums[k] = Σ of what `add` adds to the k-th of its N sums, over rows [begin, end). add(get, s) is called
/// for several rows at once and for one: get(column) are their numbers in a column of floats, and s[k] is as
/// wide.
template <std::size_t N, class Add>
void sum_rows(std::size_t begin, std::size_t end, const Add& add, double* sums) {
  const std::size_t whole = begin + (end - begin) / k_sum_lanes * k_sum_lanes;
  double lanes[N][k_sum_lanes];
  for (std::size_t l = 0; l < k_sum_lanes; l += k_doubles) {
    Doubles s[N] = {};
    for (std::size_t i = begin + l; i < whole; i += k_sum_lanes)
      add([i](const float* column) { return load_doubles(column + i); }, s);
    for (std::size_t k = 0; k < N; ++k) copy_bytes(lanes[k] + l, &s[k], sizeof s[k]);
  }
  for (std::size_t k = 0; k < N; ++k) {
    sums[k] = 0;
    for (std::size_t l = 0; l < k_sum_lanes; ++l) sums[k] += lanes[k][l];
  }
  for (std::size_t i = whole; i < end; ++i)
    add([i](const float* column) { return static_cast<double>(column[i]); }, sums);
}

}  // namespace
}  // namespace mallow::MALLOW_LEVEL

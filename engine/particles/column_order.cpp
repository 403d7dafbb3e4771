#include "particles/column_order.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

/// Columns per point at the most; beyond that the covered rectangle shrinks, and what strays from it counts
/// to its border.
constexpr double k_columns_per_point = 8.0;
constexpr double k_min_columns = 32768.0;
/// Columns that a thread sorts at once.
constexpr std::size_t k_column_block = 32;

void choose_columns(const VectorColumn& x, std::size_t begin, std::size_t end, float width,
                    const Threads& threads, ColumnOrder& columns) {
  const Aabb box = bounds_of(x, begin, end, threads, columns.partial_bounds);
  Eigen::Index longest = 0;
  (box.max - box.min).maxCoeff(&longest);
  columns.along = static_cast<int>(longest);
  columns.across = {(columns.along + 1) % 3, (columns.along + 2) % 3};
  const double budget = std::max(k_min_columns, k_columns_per_point * static_cast<double>(end - begin));
  const auto w = static_cast<double>(width);
  double low[2], size[2], mean[2];
  for (int k = 0; k < 2; ++k) {
    const int axis = columns.across[static_cast<std::size_t>(k)];
    low[k] = static_cast<double>(box.min[axis]);
    size[k] = static_cast<double>(box.max[axis]) - low[k];
    mean[k] = low[k] + 0.5 * size[k];
  }
  const auto count = [&](int k) { return std::floor(size[k] / w + 0.5) + 1.0; };
  if (count(0) * count(1) > budget) {
    for (int k = 0; k < 2; ++k) {
      const float* const values =
          x.axis(static_cast<std::size_t>(columns.across[static_cast<std::size_t>(k)]));
      mean[k] = 0;
      for (std::size_t i = begin; i < end; ++i) mean[k] += static_cast<double>(values[i]);
      mean[k] /= static_cast<double>(end - begin);
    }
  }
  while (count(0) * count(1) > budget) {
    // The size itself: far from 0 two ends would not come any nearer than they are rounded.
    const int k = size[0] > size[1] ? 0 : 1;
    size[k] *= 0.8;
    low[k] = mean[k] + 0.8 * (low[k] - mean[k]);
  }
  columns.inverse_width = static_cast<float>(1.0 / w);
  for (int k = 0; k < 2; ++k) {
    const auto a = static_cast<std::size_t>(k);
    // The outermost line of a lattice in the middle of its column, and with it all others.
    columns.origin[a] = static_cast<float>(low[k] - 0.5 * w);
    columns.dims[a] = static_cast<int>(count(k));
  }
}

/// The column that each point lies in.
void find_columns(const VectorColumn& positions, std::size_t begin, std::size_t n, const Threads& threads,
                  ColumnOrder& columns) {
  const float* x[2];
  for (std::size_t k = 0; k < 2; ++k)
    x[k] = positions.axis(static_cast<std::size_t>(columns.across[k])) + begin;
  const auto place = [&](float value, std::size_t k) {
    const float at = std::floor((value - columns.origin[k]) * columns.inverse_width);
    return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(columns.dims[k] - 1)));
  };
  columns.column_of.resize_unset(n);
  parallel_for(threads, n, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      columns.column_of[i] = static_cast<std::uint32_t>(columns.column(place(x[0][i], 0), place(x[1][i], 1)));
  });
}

/// Sorts the points [first, last) of the order, one column, along it.
void sort_column(const float* along, std::uint32_t* first, std::uint32_t* last,
                 std::vector<std::pair<float, std::uint32_t>>& keys) {
  keys.clear();
  for (const std::uint32_t* i = first; i < last; ++i) keys.emplace_back(along[*i], *i);
  if (std::is_sorted(keys.begin(), keys.end())) return;
  std::sort(keys.begin(), keys.end());
  for (std::size_t k = 0; k < keys.size(); ++k) first[k] = keys[k].second;
}

}  // namespace

void order_by_columns(const VectorColumn& positions, std::size_t begin, std::size_t end, float width,
                      const Threads& threads, InstructionLevel level, ColumnOrder& columns) {
  const std::size_t n = end - begin;
  choose_columns(positions, begin, end, width, threads, columns);
  const auto strips =
      static_cast<std::size_t>((columns.dims[0] + ColumnOrder::k_strip - 1) / ColumnOrder::k_strip);
  const std::size_t count = strips * ColumnOrder::k_strip * static_cast<std::size_t>(columns.dims[1]);
  find_columns(positions, begin, n, threads, columns);
  sort_by_key(columns.column_of, count, threads, level, columns.sort, columns.start, columns.order);
  columns.sorted.resize_unset(n);
  const float* const along = positions.axis(static_cast<std::size_t>(columns.along)) + begin;
  std::atomic<bool> already = true;
  parallel_for(
      threads, count,
      [&](std::size_t first, std::size_t last) {
        thread_local std::vector<std::pair<float, std::uint32_t>> keys;
        std::uint32_t* const order = columns.order.data();
        for (std::size_t column = first; column < last; ++column)
          sort_column(along, order + columns.start[column], order + columns.start[column + 1], keys);
        bool same = true;
        const std::size_t from = columns.start[first], to = columns.start[last];
        for (std::size_t s = from; s < to; ++s) same = same && order[s] == s;
        for (std::size_t a = 0; a < 3; ++a) {
          const float* const values = positions.axis(a) + begin;
          float* const sorted = columns.sorted.axis(a);
          for (std::size_t s = from; s < to; ++s) sorted[s] = values[order[s]];
        }
        if (!same) already.store(false, std::memory_order_relaxed);
      },
      k_column_block);
  columns.already = already;
}

}  // namespace mallow

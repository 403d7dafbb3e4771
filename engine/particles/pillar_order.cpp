#include "particles/pillar_order.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

/// Pillars per point at the most; beyond that the covered rectangle shrinks, and what strays from it counts
/// to its border.
constexpr double k_pillars_per_point = 8.0;
constexpr double k_min_pillars = 32768.0;
/// Pillars that a thread sorts at once.
constexpr std::size_t k_pillar_block = 32;

void choose_pillars(const VectorColumn& x, std::size_t begin, std::size_t end, float width,
                    const Threads& threads, PillarOrder& pillars) {
  const Aabb box = bounds_of(x, begin, end, threads, pillars.partial_bounds);
  Eigen::Index longest = 0;
  (box.max - box.min).maxCoeff(&longest);
  pillars.along = static_cast<int>(longest);
  pillars.across = {(pillars.along + 1) % 3, (pillars.along + 2) % 3};
  const double budget = std::max(k_min_pillars, k_pillars_per_point * static_cast<double>(end - begin));
  const auto w = static_cast<double>(width);
  double low[2], size[2], mean[2];
  for (int k = 0; k < 2; ++k) {
    const int axis = pillars.across[static_cast<std::size_t>(k)];
    low[k] = static_cast<double>(box.min[axis]);
    size[k] = static_cast<double>(box.max[axis]) - low[k];
    mean[k] = low[k] + 0.5 * size[k];
  }
  const auto count = [&](int k) { return std::floor(size[k] / w + 0.5) + 1.0; };
  if (count(0) * count(1) > budget) {
    for (int k = 0; k < 2; ++k) {
      const float* const values =
          x.axis(static_cast<std::size_t>(pillars.across[static_cast<std::size_t>(k)]));
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
  pillars.inverse_width = static_cast<float>(1.0 / w);
  for (int k = 0; k < 2; ++k) {
    const auto a = static_cast<std::size_t>(k);
    // The outermost line of a lattice in the middle of its pillar, and with it all others.
    pillars.origin[a] = static_cast<float>(low[k] - 0.5 * w);
    pillars.dims[a] = static_cast<int>(count(k));
  }
}

/// The pillar that each point lies in.
void find_pillars(const VectorColumn& positions, std::size_t begin, std::size_t n, const Threads& threads,
                  PillarOrder& pillars) {
  const float* x[2];
  for (std::size_t k = 0; k < 2; ++k)
    x[k] = positions.axis(static_cast<std::size_t>(pillars.across[k])) + begin;
  const auto place = [&](float value, std::size_t k) {
    // Not below 0 once it is clamped, so that the cast rounds down.
    const float at = (value - pillars.origin[k]) * pillars.inverse_width;
    return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(pillars.dims[k] - 1)));
  };
  pillars.pillar_of.resize_unset(n);
  parallel_for(threads, n, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      pillars.pillar_of[i] = static_cast<std::uint32_t>(pillars.pillar(place(x[0][i], 0), place(x[1][i], 1)));
  });
}

/// Sorts the points [first, last) of the order, one pillar, along it.
void sort_pillar(const float* along, std::uint32_t* first, std::uint32_t* last,
                 std::vector<std::pair<float, std::uint32_t>>& keys) {
  keys.clear();
  for (const std::uint32_t* i = first; i < last; ++i) keys.emplace_back(along[*i], *i);
  if (std::is_sorted(keys.begin(), keys.end())) return;
  std::sort(keys.begin(), keys.end());
  for (std::size_t k = 0; k < keys.size(); ++k) first[k] = keys[k].second;
}

}  // namespace

void order_by_pillars(const VectorColumn& positions, std::size_t begin, std::size_t end, float width,
                      const Execution& execution, PillarOrder& pillars) {
  const std::size_t n = end - begin;
  choose_pillars(positions, begin, end, width, execution.threads, pillars);
  const auto strips =
      static_cast<std::size_t>((pillars.dims[0] + PillarOrder::k_strip - 1) / PillarOrder::k_strip);
  const std::size_t count = strips * PillarOrder::k_strip * static_cast<std::size_t>(pillars.dims[1]);
  find_pillars(positions, begin, n, execution.threads, pillars);
  sort_by_key(pillars.pillar_of, count, execution, pillars.sort, pillars.start, pillars.order);
  pillars.sorted.resize_unset(n);
  const float* const along = positions.axis(static_cast<std::size_t>(pillars.along)) + begin;
  std::atomic<bool> already = true;
  parallel_for(
      execution.threads, count,
      [&](std::size_t first, std::size_t last) {
        thread_local std::vector<std::pair<float, std::uint32_t>> keys;
        std::uint32_t* const order = pillars.order.data();
        for (std::size_t pillar = first; pillar < last; ++pillar)
          sort_pillar(along, order + pillars.start[pillar], order + pillars.start[pillar + 1], keys);
        bool same = true;
        const std::size_t from = pillars.start[first], to = pillars.start[last];
        for (std::size_t s = from; s < to; ++s) same = same && order[s] == s;
        for (std::size_t a = 0; a < 3; ++a) {
          const float* const values = positions.axis(a) + begin;
          float* const sorted = pillars.sorted.axis(a);
          for (std::size_t s = from; s < to; ++s) sorted[s] = values[order[s]];
        }
        if (!same) already.store(false, std::memory_order_relaxed);
      },
      k_pillar_block);
  pillars.already = already;
}

}  // namespace mallow

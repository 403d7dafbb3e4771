#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>
#include <vector>

namespace mallow {

/// Sets of the numbers below a count that only ever grow together; a set is known by its least number.
/// [Tarjan 1975]
class DisjointSets {
 public:
  /// Every number below `count` alone.
  void reset(std::size_t count) {
    parents_.resize(count);
    std::iota(parents_.begin(), parents_.end(), std::uint32_t{0});
    count_ = count;
  }
  /// How many there are.
  std::size_t count() const { return count_; }
  std::uint32_t root(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];  // halves the way for the next one
    return i;
  }
  /// Returns the root of the set that both are in now.
  std::uint32_t join(std::uint32_t i, std::uint32_t j) {
    if (parents_[j] == i && parents_[i] == i) return i;
    i = root(i);
    j = root(j);
    count_ -= i != j;
    return parents_[std::max(i, j)] = std::min(i, j);
  }
  /// How large they are, largest first.
  std::vector<std::size_t> sizes() {
    std::vector<std::size_t> sizes(parents_.size(), 0);
    for (std::uint32_t i = 0; i < parents_.size(); ++i) ++sizes[root(i)];
    std::erase(sizes, std::size_t{0});
    std::ranges::sort(sizes, std::greater<>());
    return sizes;
  }

 private:
  std::vector<std::uint32_t> parents_;
  std::size_t count_ = 0;
};

/// Sets below this size are crumbs: a few particles that a splash throws off.
inline constexpr std::size_t k_crumb = 4;

/// How many are no crumbs. sizes: of DisjointSets.
inline std::size_t count_parts(std::span<const std::size_t> sizes) {
  return static_cast<std::size_t>(
      std::ranges::count_if(sizes, [](std::size_t size) { return size >= k_crumb; }));
}

}  // namespace mallow

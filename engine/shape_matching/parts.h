#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/disjoint_sets.h"
#include "shape_matching/shape_matching.h"

namespace mallow {

/// Parts of a body, which shape matching does not hold together: particles are in one part where they share a
/// region, directly or through others.
struct Parts {
  static constexpr std::uint32_t k_none = UINT32_MAX;
  std::vector<std::uint32_t> of;  ///< per particle the least one of its part, or k_none where that is a crumb
  std::size_t count = 0;          ///< crumbs left out
  std::size_t crumbs = 0;         ///< how many there are

  // Scratch.
  DisjointSets sets;
  std::vector<std::uint32_t> number;
};

/// Those of a shape whose regions are built.
void find_parts(const ShapeMatching& shape, Parts& parts);
/// Those of particles that come behind.
void append_parts(const Parts& behind, Parts& parts);
/// Follows particles that were sorted: k becomes what order[k] was.
void sort_parts(std::span<const std::uint32_t> order, Parts& parts);
/// Whether particles of one part of `a` are in two of `b`: `a` was torn where it is older, `b` is merged
/// where that is. Uses the scratch of `a`.
bool any_in_two(Parts& a, const Parts& b);

}  // namespace mallow

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

/// Those of a shape whose regions are built: the ones that it keeps, or found anew.
void find_parts(const ShapeMatching& shape, Parts& parts);
/// Keeps those found of a shape with it until its regions are listed anew. A shape in one part keeps no rows.
void keep_parts(const Parts& parts, ShapeMatching& shape);
/// Those of particles that come behind.
void append_parts(const Parts& behind, Parts& parts);
/// Follows particles that were sorted: k becomes what order[k] was.
void sort_parts(std::span<const std::uint32_t> order, Parts& parts);
/// Whether particles of one part of `a` are in two of `b`: `a` was torn where it is older, `b` is merged
/// where that is. Uses the scratch of `a`.
bool any_in_two(Parts& a, const Parts& b);

/// Particles that some others, which go, held together: they shared regions with these.
struct HeldTogether {
  std::vector<std::uint32_t> rows;   ///< ascending, those that go left out
  std::vector<std::uint32_t> group;  ///< of each: the same where they were in one part through those that go
};
/// places: of those that will go, ascending; of a shape whose regions are built.
HeldTogether held_together_by(std::span<const std::uint32_t> places, const ShapeMatching& shape);
/// Whether particles of a group are in two parts now that regions are built without those that went; parts
/// are found only then, or where the regions of the group alone do not say. former: what each row was.
bool are_torn(const HeldTogether& held, std::span<const std::uint32_t> former, const ShapeMatching& shape,
              Parts& parts);

}  // namespace mallow

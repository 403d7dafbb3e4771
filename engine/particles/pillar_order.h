#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/column.h"
#include "core/counting_sort.h"
#include "core/execution.h"
#include "mallow/vec3.h"

namespace mallow {

/// Points in square pillars along the longest axis of their bounds, and along that axis within a pillar: of
/// all that lies in a ball, what lies in one pillar is consecutive, or nearly. Pillars as wide as the spacing
/// of a lattice hold one line of it each.
///
/// Pillars are counted strip by strip: a strip is k_strip pillars wide in the first axis across and runs
/// through all of the second, so that what is near a point lies within a few pillars' worth of memory
/// whatever the size of the body.
struct PillarOrder {
  static constexpr int k_strip = 8;

  int along = 0;                  ///< axis of the pillars
  std::array<int, 2> across{};    ///< the other two
  std::array<float, 2> origin{};  ///< low corner of the first pillar [m]
  float inverse_width = 0;        ///< [1/m]
  std::array<int, 2> dims{};      ///< pillars across
  Column<std::uint32_t> start;    ///< pillars + 1: first sorted point of each
  Column<std::uint32_t> order;    ///< point of each sorted place
  VectorColumn sorted;            ///< positions in sorted order [m]
  bool already = false;           ///< the points came in this order

  // Scratch.
  Column<std::uint32_t> pillar_of;
  CountingSort sort;
  std::vector<Aabb> partial_bounds;

  std::size_t pillars() const { return start.size() - 1; }
  /// Number of the pillar at these places across.
  std::size_t pillar(int a, int b) const {
    const auto strip = static_cast<std::size_t>(a / k_strip),
               in_strip = static_cast<std::size_t>(a % k_strip);
    return (strip * static_cast<std::size_t>(dims[1]) + static_cast<std::size_t>(b)) * k_strip + in_strip;
  }
  std::size_t bytes() const {
    return start.bytes() + order.bytes() + sorted.bytes() + pillar_of.bytes() + sort.bytes();
  }
};

/// The same order for any number of threads; points at one place keep theirs. positions: finite. width: > 0
/// [m].
void order_by_pillars(const VectorColumn& positions, std::size_t begin, std::size_t end, float width,
                      const Execution& execution, PillarOrder& pillars);

}  // namespace mallow

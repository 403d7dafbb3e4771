#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "mallow/vec3.h"
#include "particles/pillar_order.h"
#include "shape_matching/shape_lanes.h"

namespace mallow {

struct TableLists;

/// What a list has of its former one: not the same points, or those, or those in the same runs. A list that
/// keeps its runs is not written to `runs`: it is read from the former lists, with the rows of now.
enum class Kept : std::uint8_t { none, points, runs };

/// Per row a list of rows as runs, ascending and apart from each other.
struct RunLists {
  Column<std::uint32_t> begin;    ///< per row: where its list starts in `runs`
  Column<std::uint32_t> count;    ///< per row: runs
  Column<std::uint32_t> members;  ///< per row: rows in its runs
  Column<Run> runs;               ///< the lists, with unused space between blocks
  Column<Kept> kept;  ///< per row: of its former list; empty where none was known; of kept runs none is here

  std::span<const Run> of(std::size_t row) const { return {runs.data() + begin[row], count[row]}; }
  std::size_t bytes() const {
    return begin.bytes() + count.bytes() + members.bytes() + runs.bytes() + kept.bytes();
  }
};

/// Lists of points before some came, went or moved to other rows.
struct FormerLists {
  static constexpr std::uint32_t k_none = ~0u;

  const TableLists& lists;                ///< by former row
  std::span<const std::uint32_t> former;  ///< per row: what it was; of what came k_none
  /// Per former row: the rows that it and those behind it are, as far as they still follow each other; none
  /// if it went.
  std::span<const Run> now;
  Aabb news;                      ///< around all that came
  std::span<const float> weight;  ///< by former row: 1 over how many points are in its list
};

/// Per point the points within a radius of it, itself included, by their rows: a row is what a point was
/// before the order sorted it. Where the lists of a block of points lie in `runs` may differ from call to
/// call, what they hold does not. Of two points each is in the other's list, or none. Throws ConfigError
/// where there would be 2^32 runs. former: with the same radius, of the same points but for those that came
/// and went. What is out of reach of all that came is then not searched for, the lists are the same.
void find_runs(const PillarOrder& pillars, float radius, const Execution& execution, RunLists& lists,
               const FormerLists* former = nullptr);

}  // namespace mallow

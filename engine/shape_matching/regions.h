#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "core/threads.h"
#include "particles/pillar_order.h"
#include "shape_matching/plastic.h"
#include "shape_matching/run_tables.h"

namespace mallow {

struct ShapeMatching;

/// What building regions needs besides them; all bodies take turns with it.
struct RegionScratch {
  PillarOrder pillars;
  RunLists near;                       ///< per particle: those within the region radius
  TableLists former;                   ///< lists before some particles came or went
  Column<std::uint32_t> owners;        ///< particles that own a region, ascending; with a stride above 1
  Column<std::uint32_t> first_region;  ///< per particle: regions of the particles before it
  Column<std::uint8_t> changed;        ///< per region: measured anew; empty where all are
  Column<float> carried;               ///< what regions keep, on its way to other rows
  VectorColumn carried_center;         ///< likewise
  std::vector<std::uint32_t> block_begin;
  std::vector<std::array<double, 3>> partial_sums;
  std::vector<std::size_t> partial_count;
  FlowScratch flow;

  std::size_t bytes() const {
    return pillars.bytes() + near.bytes() + former.bytes() + owners.bytes() + first_region.bytes() +
           changed.bytes() + carried.bytes() + carried_center.bytes() + flow.bytes();
  }
};

/// x̄ ← x of the rows [begin, end) of a store. Rotations start from none; regions are due to be built.
void update_reference(const VectorColumn& positions, std::size_t begin, std::size_t end,
                      const Threads& threads, RegionScratch& scratch, ShapeMatching& shape);
/// Puts the rows of a reference shape in the order in which regions are fast: row k becomes what row
/// pillars.order[k] was. The other columns of the particles have to follow.
void sort_reference(const Execution& execution, PillarOrder& pillars, ShapeMatching& shape);
/// Which particles are in which region: owners, lists, w_i. One of every region_stride particles owns a
/// region, and so does every particle that is in none of theirs. Right for any order of the particles, fast
/// after sort_reference, and owners are spread evenly then. The scratch keeps the lists as runs. former: the
/// lists are those before some particles came or went; only with a stride of 1 do they save anything.
void list_regions(const Execution& execution, RegionScratch& scratch, ShapeMatching& shape,
                  const FormerLists* former = nullptr);
/// What follows from x̄, of the regions that were listed last: W_j, c̄_j, B_j. former: as they were listed
/// with; regions keep what they have where that would be the same bits.
void measure_regions(const Execution& execution, RegionScratch& scratch, ShapeMatching& shape,
                     const FormerLists* former = nullptr);
/// Both, with rotations that start from none and room for the sums.
void build_regions(const Execution& execution, RegionScratch& scratch, ShapeMatching& shape,
                   const FormerLists* former = nullptr);
/// Whether a row is drawn to own a region: of every `stride` in a row one is, at a scattered place. Every
/// third row of a lattice of 12 is whole lines of it, and bent ten times as wrongly as every second or
/// fourth.
bool is_drawn(std::uint32_t row, std::uint32_t stride);

}  // namespace mallow

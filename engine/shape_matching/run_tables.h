#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/column.h"
#include "core/threads.h"
#include "shape_matching/run_lists.h"
#include "shape_matching/shape_lanes.h"

namespace mallow {

/// Lists of rows, to be summed, as lists of entries of a table that holds sums of consecutive rows: entry
/// l rows + i is the sum of the lengths.length[l] rows from i on. One entry stands for a whole run
/// where the table has its length, for a part of it otherwise. Unlike differences of running totals the
/// entries of a list only add, so no digit cancels. A table is worth its lengths only where enough lists use
/// them; with none but 1 it is the rows themselves, and the lists are plain.
///
/// For example eight rows a to h, and the lengths 1, 2 and 4:
///
///   from row     |    0      1      2      3      4      5      6      7
///   l = 0, one   | 0: a   1: b   2: c   3: d   4: e   5: f   6: g   7: h
///   l = 1, two   | 8: ab  9: bc 10: cd 11: de 12: ef 13: fg 14: gh 15: h
///   l = 2, four  | 16: abcd     18: cdef      20: efgh      22: gh         and those between
///
///   rows of a list |  a  |     |  c     d     e     f  |  g     h  |
///   its entries    |  0  |     |          18           |    14     |
///
/// The list has seven rows in two runs. The run of one is entry 0. The run of six has no entry of its own: it
/// is four rows from row 2 on, 2 * 8 + 2 = 18, and two from row 6 on, 1 * 8 + 6 = 14. Three additions do for
/// seven. Behind the last row there is nothing to add: entry 15 is h alone.
struct TableLists {
  Column<std::uint32_t> begin;    ///< per list: where it starts in `entries`
  Column<std::uint32_t> count;    ///< per list: entries
  Column<std::uint32_t> entries;  ///< lists behind each other, and some of row 0 for whoever reads ahead
  std::size_t total = 0;          ///< entries of all lists
  RunLengths lengths;
  std::size_t rows = 0;     ///< of the table
  std::size_t members = 0;  ///< rows in all lists
  using Histogram = std::array<std::uint64_t, k_longest_run + 1>;
  Histogram runs{};  ///< how many runs of n rows the lists have, of longer ones their parts; at 0 `members`

  // Scratch.
  std::vector<Histogram> partial_runs;
  std::vector<std::uint32_t> block_begin;

  /// Calls visit(first row, how many) for the runs of a list.
  template <class Visit>
  void for_each_run(std::size_t list, const Visit& visit) const {
    const auto n = static_cast<std::uint32_t>(rows);
    const std::uint32_t* const own = entries.data() + begin[list];
    for (std::uint32_t k = 0; k < count[list]; ++k) visit(own[k] % n, lengths.length[own[k] / n]);
  }
  /// The same with whole runs, of however many entries.
  template <class Visit>
  void for_each_whole_run(std::size_t list, const Visit& visit) const {
    const auto n = static_cast<std::uint32_t>(rows);
    const std::uint32_t* const own = entries.data() + begin[list];
    for (std::uint32_t k = 0; k < count[list];) {
      const std::uint32_t first = own[k] % n;
      std::uint32_t end = first;
      for (; k < count[list] && own[k] % n == end; ++k) end += lengths.length[own[k] / n];
      visit(first, end - first);
    }
  }
  std::size_t bytes() const { return begin.bytes() + count.bytes() + entries.bytes(); }
};

/// Chooses the lengths of a table of `rows` rows that make lists cheapest, table included. runs[n]: how many
/// runs of n rows the lists have; longer ones count as several.
RunLengths choose_lengths(const TableLists::Histogram& runs, std::size_t rows);
/// The lists of `owners`, or all where there are none, for a table of `rows` rows. former: what find_runs()
/// was given, of other lists than `coded`, which is overwritten while they are read; without owners.
void encode(const RunLists& lists, std::span<const std::uint32_t> owners, std::size_t rows,
            const Threads& threads, TableLists& coded, const FormerLists* former = nullptr);
/// All but scratch.
void copy_lists(const TableLists& from, TableLists& to);
/// The rows of a list.
std::vector<std::uint32_t> decode(const TableLists& coded, std::size_t list);

}  // namespace mallow

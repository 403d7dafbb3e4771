#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "shape_matching/run_tables.h"

/// Sums over lists in double, for what is seldom done. Differences of moments lose the digits that a square
/// of size over strain has; a double has them to spare.
namespace mallow {

/// Sums over lists of rows, each of `count` numbers that lie behind each other.
template <int count>
using Numbers = Eigen::Array<double, count, 1>;

/// What the rows of every list have in sum, by a table of runs as in the steps.
template <int count>
std::vector<Numbers<count>> sum_lists(const TableLists& lists, std::vector<Numbers<count>> table) {
  const std::size_t rows = lists.rows;
  table.reserve(rows * lists.lengths.count);
  for (std::uint32_t l = 1; l < lists.lengths.count; ++l)
    for (std::size_t i = 0; i < rows; ++i) {
      Numbers<count> sum = table[(l - 1) * rows + i];
      const std::size_t end = std::min(rows, i + lists.lengths.length[l]);
      for (std::size_t k = i + lists.lengths.length[l - 1]; k < end; ++k) sum += table[k];
      table.push_back(sum);
    }
  std::vector<Numbers<count>> sums(lists.count.size(), Numbers<count>::Zero());
  for (std::size_t list = 0; list < sums.size(); ++list)
    for (std::uint32_t k = 0; k < lists.count[list]; ++k)
      sums[list] += table[lists.entries[lists.begin[list] + k]];
  return sums;
}

}  // namespace mallow

#include "shape_matching/run_tables.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

/// Entries that 32-bit places can name.
constexpr std::size_t k_max_entries = std::numeric_limits<std::uint32_t>::max();

using Histogram = TableLists::Histogram;

/// What one more length costs a row, in additions of a list: an addition, a store, and the cache that the
/// sums take from others. Measured: see bench/kernels.
constexpr double k_cost_of_length = 4.0;

/// How runs of up to k_longest_run rows are put together from the lengths of a table with fewest entries.
struct Pieces {
  std::array<std::uint32_t, k_longest_run + 1> count{};
  std::array<std::uint32_t, k_longest_run + 1> longest{};  ///< which length the first entry has

  explicit Pieces(const RunLengths& lengths) {
    for (std::uint32_t n = 1; n <= k_longest_run; ++n) {
      count[n] = ~0u;
      for (std::uint32_t l = lengths.count; l-- > 0;) {
        const std::uint32_t length = lengths.length[l];
        if (length > n || count[n - length] + 1 >= count[n]) continue;
        count[n] = count[n - length] + 1;
        longest[n] = l;
      }
    }
  }
  double entries(const Histogram& runs) const {
    double sum = 0;
    for (std::size_t n = 1; n <= k_longest_run; ++n)
      sum += static_cast<double>(runs[n]) * static_cast<double>(count[n]);
    return sum;
  }
};

RunLengths with(RunLengths lengths, std::uint32_t length) {
  std::uint32_t l = lengths.count++;
  for (; l > 0 && lengths.length[l - 1] > length; --l) lengths.length[l] = lengths.length[l - 1];
  lengths.length[l] = length;
  return lengths;
}

/// Calls body(n) for the parts of at most k_longest_run that a run is made of.
template <class Body>
void for_each_part(std::uint32_t count, const Body& body) {
  for (; count > k_longest_run; count -= k_longest_run) body(k_longest_run);
  body(count);
}

Histogram count_runs(const RunLists& lists, std::span<const std::uint32_t> owners, std::size_t n,
                     const Threads& threads, TableLists& coded) {
  return parallel_reduce(
      threads, n, coded.partial_runs, Histogram{},
      [&](std::size_t begin, std::size_t end) {
        Histogram runs{};
        for (std::size_t j = begin; j < end; ++j)
          for (const Run& run : lists.of(owners.empty() ? j : owners[j])) {
            for_each_part(run.count, [&](std::uint32_t part) { ++runs[part]; });
            runs[0] += run.count;
          }
        return runs;
      },
      [](Histogram a, const Histogram& b) {
        for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
        return a;
      });
}

}  // namespace

RunLengths choose_lengths(const Histogram& runs, std::size_t rows) {
  RunLengths lengths;
  double cost = Pieces(lengths).entries(runs);
  while (lengths.count < k_max_lengths) {
    double best_cost = cost;
    RunLengths best = lengths;
    for (std::uint32_t n = 2; n <= k_longest_run; ++n) {
      if (std::find(lengths.length, lengths.length + lengths.count, n) != lengths.length + lengths.count)
        continue;
      const RunLengths longer = with(lengths, n);
      const double new_cost = Pieces(longer).entries(runs);
      if (new_cost >= best_cost) continue;
      best_cost = new_cost;
      best = longer;
    }
    if (best_cost + k_cost_of_length * static_cast<double>(rows) >= cost) break;
    cost = best_cost;
    lengths = best;
  }
  return lengths;
}

void encode(const RunLists& lists, std::span<const std::uint32_t> owners, std::size_t rows,
            const Threads& threads, TableLists& coded) {
  const std::size_t n = owners.empty() ? lists.count.size() : owners.size();
  const Histogram runs = count_runs(lists, owners, n, threads, coded);
  coded.members = runs[0];
  coded.lengths = choose_lengths(runs, rows);
  const Pieces pieces(coded.lengths);
  const auto all = static_cast<std::uint32_t>(rows);
  coded.rows = rows;
  coded.begin.resize_unset(n);
  coded.count.resize_unset(n);
  coded.block_begin.resize((n + k_block - 1) / k_block);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    std::uint32_t sum = 0;
    for (std::size_t j = begin; j < end; ++j) {
      std::uint32_t count = 0;
      for (const Run& run : lists.of(owners.empty() ? j : owners[j]))
        for_each_part(run.count, [&](std::uint32_t part) { count += pieces.count[part]; });
      coded.count[j] = count;
      sum += count;
    }
    coded.block_begin[begin / k_block] = sum;
  });
  std::size_t total = 0;
  for (std::uint32_t& block : coded.block_begin) {
    const std::uint32_t sum = block;
    block = static_cast<std::uint32_t>(total);
    total += sum;
  }
  if (std::max(total, rows * coded.lengths.count) > k_max_entries)
    throw ConfigError("support_radius", "the regions would need " + std::to_string(total) +
                                            " entries; at most 4294967295 fit: choose a smaller radius");
  coded.total = total;
  coded.entries.resize_unset(total + k_prefetch + 4);
  std::fill(coded.entries.begin() + total, coded.entries.end(), 0u);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    std::uint32_t next = coded.block_begin[begin / k_block];
    for (std::size_t j = begin; j < end; ++j) {
      coded.begin[j] = next;
      for (const Run& run : lists.of(owners.empty() ? j : owners[j])) {
        std::uint32_t row = run.first;
        for_each_part(run.count, [&](std::uint32_t part) {
          while (part > 0) {
            const std::uint32_t l = pieces.longest[part];
            coded.entries[next++] = l * all + row;
            row += coded.lengths.length[l];
            part -= coded.lengths.length[l];
          }
        });
      }
    }
  });
}

std::vector<std::uint32_t> decode(const TableLists& coded, std::size_t list) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t k = 0; k < coded.count[list]; ++k) {
    const std::uint32_t entry = coded.entries[coded.begin[list] + k];
    const std::uint32_t row = entry % static_cast<std::uint32_t>(coded.rows);
    for (std::uint32_t r = 0; r < coded.lengths.length[entry / coded.rows]; ++r) rows.push_back(row + r);
  }
  return rows;
}

}  // namespace mallow

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

/// Where the runs of lists are.
struct Source {
  const RunLists& lists;
  std::span<const std::uint32_t> owners;
  const FormerLists* former;  ///< null: all are in `lists`

  bool is_kept(std::size_t j) const { return former && lists.kept[j] == Kept::runs; }
  /// Calls visit(first row, how many) for the runs of a list.
  template <class Visit>
  void for_each_run(std::size_t j, const Visit& visit) const {
    if (is_kept(j))
      return former->lists.for_each_whole_run(
          former->former[j],
          [&](std::uint32_t first, std::uint32_t count) { visit(former->now[first].first, count); });
    for (const Run& run : lists.of(owners.empty() ? j : owners[j])) visit(run.first, run.count);
  }
};

void add_run(std::uint32_t count, Histogram& runs) {
  for_each_part(count, [&](std::uint32_t part) { ++runs[part]; });
  runs[0] += count;
}

Histogram count_all_runs(const Source& source, std::size_t n, const Threads& threads, TableLists& coded) {
  return parallel_reduce(
      threads, n, coded.partial_runs, Histogram{},
      [&](std::size_t begin, std::size_t end) {
        Histogram runs{};
        for (std::size_t j = begin; j < end; ++j)
          source.for_each_run(j, [&](std::uint32_t, std::uint32_t count) { add_run(count, runs); });
        return runs;
      },
      [](Histogram a, const Histogram& b) {
        for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
        return a;
      });
}

/// From those of former lists, less those that are no more, and those that are new.
Histogram count_other_runs(const Source& source, std::size_t n) {
  const FormerLists& former = *source.former;
  Histogram gone{}, came{}, runs = former.lists.runs;
  for (std::size_t r = 0; r < former.now.size(); ++r)
    if (former.now[r].count == 0 || !source.is_kept(former.now[r].first))
      former.lists.for_each_whole_run(r, [&](std::uint32_t, std::uint32_t count) { add_run(count, gone); });
  for (std::size_t j = 0; j < n; ++j)
    if (!source.is_kept(j))
      source.for_each_run(j, [&](std::uint32_t, std::uint32_t count) { add_run(count, came); });
  for (std::size_t k = 0; k < runs.size(); ++k) runs[k] = runs[k] - gone[k] + came[k];
  return runs;
}

Histogram count_runs(const Source& source, std::size_t n, const Threads& threads, TableLists& coded) {
  const auto kept = source.former ? std::ranges::count(source.lists.kept, Kept::runs) : 0;
  return 2 * static_cast<std::size_t>(kept) > n ? count_other_runs(source, n)
                                                : count_all_runs(source, n, threads, coded);
}

bool are_same(const RunLengths& a, const RunLengths& b) {
  return std::equal(a.length, a.length + a.count, b.length, b.length + b.count);
}

/// Writes lists as entries of a table of `rows` rows.
class Encoder {
 public:
  Encoder(const Source& source, std::size_t rows, const RunLengths& lengths)
      : source_(source),
        lengths_(lengths),
        pieces_(lengths),
        all_(static_cast<std::uint32_t>(rows)),
        copies_(source.former && are_same(lengths, source.former->lists.lengths)) {}

  std::uint32_t entries(std::size_t j) const {
    if (copies_ && source_.is_kept(j)) return source_.former->lists.count[source_.former->former[j]];
    std::uint32_t count = 0;
    source_.for_each_run(j, [&](std::uint32_t, std::uint32_t run) {
      for_each_part(run, [&](std::uint32_t part) { count += pieces_.count[part]; });
    });
    return count;
  }

  /// Returns the place behind.
  std::uint32_t* write(std::size_t j, std::uint32_t* next) const {
    if (copies_ && source_.is_kept(j)) return copy(j, next);
    source_.for_each_run(j, [&](std::uint32_t row, std::uint32_t run) {
      for_each_part(run, [&](std::uint32_t part) {
        while (part > 0) {
          const std::uint32_t l = pieces_.longest[part];
          *next++ = l * all_ + row;
          row += lengths_.length[l];
          part -= lengths_.length[l];
        }
      });
    });
    return next;
  }

 private:
  /// Entry by entry, as its runs are as they were.
  std::uint32_t* copy(std::size_t j, std::uint32_t* next) const {
    const FormerLists& former = *source_.former;
    const std::uint32_t list = former.former[j], rows = static_cast<std::uint32_t>(former.lists.rows);
    const std::uint32_t* const entries = former.lists.entries.data() + former.lists.begin[list];
    for (std::uint32_t k = 0; k < former.lists.count[list]; ++k)
      *next++ = entries[k] / rows * all_ + former.now[entries[k] % rows].first;
    return next;
  }

  const Source& source_;
  const RunLengths lengths_;
  const Pieces pieces_;
  const std::uint32_t all_;
  const bool copies_;
};

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
            const Threads& threads, TableLists& coded, const FormerLists* former) {
  const std::size_t n = owners.empty() ? lists.count.size() : owners.size();
  const Source source{lists, owners, former};
  coded.runs = count_runs(source, n, threads, coded);
  coded.members = coded.runs[0];
  coded.lengths = choose_lengths(coded.runs, rows);
  const Encoder encoder(source, rows, coded.lengths);
  coded.rows = rows;
  coded.begin.resize_unset(n);
  coded.count.resize_unset(n);
  coded.block_begin.resize((n + k_block - 1) / k_block);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    std::uint32_t sum = 0;
    for (std::size_t j = begin; j < end; ++j) sum += coded.count[j] = encoder.entries(j);
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
    std::uint32_t* const entries = coded.entries.data();
    std::uint32_t* next = entries + coded.block_begin[begin / k_block];
    for (std::size_t j = begin; j < end; ++j) {
      coded.begin[j] = static_cast<std::uint32_t>(next - entries);
      next = encoder.write(j, next);
    }
  });
}

void copy_lists(const TableLists& from, TableLists& to) {
  const auto copy = [](const Column<std::uint32_t>& column, Column<std::uint32_t>& other) {
    other.resize_unset(column.size());
    std::ranges::copy(column, other.begin());
  };
  copy(from.begin, to.begin);
  copy(from.count, to.count);
  copy(from.entries, to.entries);
  to.total = from.total;
  to.lengths = from.lengths;
  to.rows = from.rows;
  to.members = from.members;
  to.runs = from.runs;
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

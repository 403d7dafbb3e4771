#include "shape_matching/parts.h"

namespace mallow {
namespace {

/// Regions overlap so much that one of this many joins a body that is in one piece.
constexpr std::size_t k_stride = 8;

}  // namespace

void find_parts(const ShapeMatching& shape, Parts& parts) {
  const TableLists& lists = shape.regions;
  const auto n = static_cast<std::uint32_t>(lists.rows);
  DisjointSets& sets = parts.sets;
  sets.reset(n);
  for (std::size_t start = 0; start < k_stride; ++start)
    for (std::size_t j = start; j < lists.begin.size() && sets.count() > 1; j += k_stride) {
      std::uint32_t root = sets.root(lists.entries[lists.begin[j]] % n);
      lists.for_each_run(j, [&](std::uint32_t first, std::uint32_t length) {
        for (std::uint32_t row = first; row < first + length; ++row) root = sets.join(root, row);
      });
    }
  parts.number.assign(n, 0);
  for (std::uint32_t i = 0; i < n; ++i) ++parts.number[sets.root(i)];
  parts.count = parts.crumbs = 0;
  for (const std::uint32_t size : parts.number) {
    parts.count += size >= k_crumb;
    parts.crumbs += size > 0 && size < k_crumb;
  }
  parts.of.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t root = sets.root(i);
    parts.of[i] = parts.number[root] >= k_crumb ? root : Parts::k_none;
  }
}

void append_parts(const Parts& behind, Parts& parts) {
  const auto n = static_cast<std::uint32_t>(parts.of.size());
  for (const std::uint32_t root : behind.of) parts.of.push_back(root == Parts::k_none ? root : n + root);
  parts.count += behind.count;
  parts.crumbs += behind.crumbs;
}

void sort_parts(std::span<const std::uint32_t> order, Parts& parts) {
  parts.number.resize(parts.of.size());
  for (std::size_t k = 0; k < order.size(); ++k) parts.number[k] = parts.of[order[k]];
  parts.of.swap(parts.number);
}

bool any_in_two(Parts& a, const Parts& b) {
  a.number.assign(a.of.size(), Parts::k_none);
  for (std::size_t i = 0; i < a.of.size(); ++i) {
    if (a.of[i] == Parts::k_none || b.of[i] == Parts::k_none) continue;
    std::uint32_t& first = a.number[a.of[i]];
    if (first == Parts::k_none) first = b.of[i];
    if (first != b.of[i]) return true;
  }
  return false;
}

}  // namespace mallow

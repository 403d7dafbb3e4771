#include "shape_matching/parts.h"

#include <algorithm>

namespace mallow {
namespace {

/// Regions overlap so much that one of this many joins a body that is in one piece.
constexpr std::size_t k_stride = 8;

/// Calls visit(region) with enough of those that hold a particle: with a stride of 1 its own, as of two
/// particles each is in the other's.
template <class Visit>
void for_regions_of(const ShapeMatching& shape, std::uint32_t row, const Visit& visit) {
  if (shape.region_stride == 1) return visit(row);
  shape.memberships.for_each_run(row, [&](std::uint32_t first, std::uint32_t length) {
    for (std::uint32_t region = first; region < first + length; ++region) visit(region);
  });
}
/// Calls visit(member) with all that share one of these with it.
template <class Visit>
void for_companions(const ShapeMatching& shape, std::uint32_t row, const Visit& visit) {
  for_regions_of(shape, row, [&](std::size_t region) {
    shape.regions.for_each_run(region, [&](std::uint32_t first, std::uint32_t length) {
      for (std::uint32_t member = first; member < first + length; ++member) visit(member);
    });
  });
}

/// Particles that share a region -> one set. With a stride of 1 two particles are in each other's regions, so
/// but for the first of k_stride, which nearly join a body in one piece, those behind the owner are enough.
void join_regions(const ShapeMatching& shape, DisjointSets& sets) {
  const TableLists& lists = shape.regions;
  sets.reset(lists.rows);
  for (std::size_t start = 0; start < k_stride; ++start)
    for (std::size_t j = start; j < lists.begin.size() && sets.count() > 1; j += k_stride) {
      const auto owner = static_cast<std::uint32_t>(shape.first_row(j));
      const std::uint32_t from = start > 0 && shape.region_stride == 1 ? owner + 1 : 0;
      std::uint32_t root = sets.root(owner);
      lists.for_each_run(j, [&](std::uint32_t first, std::uint32_t length) {
        for (std::uint32_t row = std::max(first, from); row < first + length; ++row)
          root = sets.join(root, row);
      });
    }
}

/// Whether one number in `groups` goes with two in `sets`; k_none there says nothing.
bool is_split(std::span<const std::uint32_t> groups, std::span<const std::uint32_t> sets) {
  std::vector<std::uint32_t> first(groups.size(), Parts::k_none);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (sets[k] == Parts::k_none) continue;
    std::uint32_t& set = first[groups[k]];
    if (set == Parts::k_none) set = sets[k];
    if (set != sets[k]) return true;
  }
  return false;
}

}  // namespace

void find_parts(const ShapeMatching& shape, Parts& parts) {
  const auto n = static_cast<std::uint32_t>(shape.regions.rows);
  if (shape.parts.known) {
    parts.count = shape.parts.count;
    parts.crumbs = shape.parts.crumbs;
    if (shape.parts.of.empty())
      parts.of.assign(n, 0);
    else
      parts.of = shape.parts.of;
    return;
  }
  DisjointSets& sets = parts.sets;
  join_regions(shape, sets);
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

void keep_parts(const Parts& parts, ShapeMatching& shape) {
  const bool is_whole = parts.count == 1 && parts.crumbs == 0;
  shape.parts = {.known = true,
                 .of = is_whole ? std::vector<std::uint32_t>() : parts.of,
                 .count = parts.count,
                 .crumbs = parts.crumbs};
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

HeldTogether held_together_by(std::span<const std::uint32_t> places, const ShapeMatching& shape) {
  std::vector<std::uint32_t> all(places.begin(), places.end());
  for (const std::uint32_t place : places)
    for_companions(shape, place, [&](std::uint32_t member) { all.push_back(member); });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  const auto number = [&](std::uint32_t row) {
    return static_cast<std::uint32_t>(std::lower_bound(all.begin(), all.end(), row) - all.begin());
  };
  DisjointSets sets;
  sets.reset(all.size());
  for (const std::uint32_t place : places)
    for_companions(shape, place,
                   [&, own = number(place)](std::uint32_t member) { sets.join(own, number(member)); });
  HeldTogether held;
  std::vector<std::uint32_t> group_of(all.size(), Parts::k_none);
  for (std::uint32_t k = 0, next = 0; k < all.size(); ++k) {
    if (std::binary_search(places.begin(), places.end(), all[k])) continue;
    std::uint32_t& group = group_of[sets.root(k)];
    if (group == Parts::k_none) group = next++;
    held.rows.push_back(all[k]);
    held.group.push_back(group);
  }
  return held;
}

bool are_torn(const HeldTogether& held, std::span<const std::uint32_t> former, const ShapeMatching& shape,
              Parts& parts) {
  constexpr std::uint32_t k_none = Parts::k_none;
  std::vector<std::uint32_t> number(former.size(), k_none), now(held.rows.size(), k_none);
  for (std::uint32_t row = 0; row < former.size(); ++row) {
    const auto place = std::lower_bound(held.rows.begin(), held.rows.end(), former[row]);
    if (place == held.rows.end() || *place != former[row]) continue;
    number[row] = static_cast<std::uint32_t>(place - held.rows.begin());
    now[number[row]] = row;
  }
  parts.sets.reset(held.rows.size());
  for (std::uint32_t k = 0; k < now.size(); ++k)
    for_companions(shape, now[k], [&](std::uint32_t member) {
      if (number[member] != k_none) parts.sets.join(k, number[member]);
    });
  std::vector<std::uint32_t> sets(now.size());
  for (std::uint32_t k = 0; k < sets.size(); ++k) sets[k] = parts.sets.root(k);
  if (!is_split(held.group, sets)) return false;
  find_parts(shape, parts);
  for (std::size_t k = 0; k < sets.size(); ++k) sets[k] = parts.of[now[k]];
  return is_split(held.group, sets);
}

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bounds.h"

namespace mallow {

/// Which of many boxes overlap one, without looking at most of them: boxes side by side share a box around
/// them, and so on, as in a bounding volume hierarchy along a space-filling curve. How long a search takes
/// follows from the order; what it finds does not.
class BoxTree {
 public:
  /// Boxes that hold nothing are never found.
  void build(std::span<const Aabb> boxes);
  /// Calls found(number of the box) for each that overlaps `box` or touches it, in no order to rely on.
  template <class Found>
  void for_overlapping(const Aabb& box, const Found& found) const {
    if (!levels_.empty()) visit(levels_.size() - 1, 0, box, found);
  }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t k_fan = 8;

  struct Place {
    std::uint64_t code;  ///< on the curve
    std::uint32_t box;
  };

  static bool overlap(const Aabb& a, const Aabb& b) {
    return (a.min.array() <= b.max.array()).all() && (b.min.array() <= a.max.array()).all();
  }

  template <class Found>
  void visit(std::size_t level, std::size_t node, const Aabb& box, const Found& found) const {
    const std::vector<Aabb>& nodes = levels_[level];
    const std::size_t end = level + 1 == levels_.size() ? nodes.size() : node + k_fan;
    for (std::size_t n = node; n < end && n < nodes.size(); ++n) {
      if (!overlap(nodes[n], box)) continue;
      if (level == 0)
        found(order_[n].box);
      else
        visit(level - 1, n * k_fan, box, found);
    }
  }

  std::vector<Place> order_;
  std::vector<std::vector<Aabb>> levels_;  ///< the boxes in this order, boxes around k_fan of them, and so on
};

}  // namespace mallow

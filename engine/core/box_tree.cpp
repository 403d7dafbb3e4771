#include "core/box_tree.h"

#include <algorithm>
#include <cmath>

namespace mallow {
namespace {

/// Steps of the curve along an axis.
constexpr int k_bits = 21;

/// The bits of a number, two zeros behind each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1F00000000FFFFu;
  bits = (bits | bits << 16) & 0x1F0000FF0000FFu;
  bits = (bits | bits << 8) & 0x100F00F00F00F00Fu;
  bits = (bits | bits << 4) & 0x10C30C30C30C30C3u;
  return (bits | bits << 2) & 0x1249249249249249u;
}

bool holds_any(const Aabb& box) {
  return (box.min.array() <= box.max.array()).all();
}

/// Along Morton's curve through a cube.
std::uint64_t place_of(const Vec3& x, const Vec3& corner, float steps_per_metre) {
  constexpr float k_last = static_cast<float>((1 << k_bits) - 1);
  std::uint64_t code = 0;
  for (int a = 0; a < 3; ++a) {
    const float step = (x[a] - corner[a]) * steps_per_metre;
    // What is no number, as far as floats go, counts to the first.
    code |= spread(step > 0 ? static_cast<std::uint64_t>(std::min(step, k_last)) : 0) << a;
  }
  return code;
}

}  // namespace

void BoxTree::build(std::span<const Aabb> boxes) {
  order_.clear();
  Aabb all = empty_box();
  for (const Aabb& box : boxes) all = box_around(all, box);
  const float edge = (all.max - all.min).maxCoeff();
  const float per_metre = std::ldexp(1.0f, k_bits) / edge;
  for (std::uint32_t b = 0; b < boxes.size(); ++b)
    if (holds_any(boxes[b]))
      order_.push_back({place_of(0.5f * (boxes[b].min + boxes[b].max), all.min, per_metre), b});
  std::ranges::sort(order_, [](const Place& a, const Place& b) {
    return a.code != b.code ? a.code < b.code : a.box < b.box;
  });

  std::size_t level = 0, count = order_.size();
  for (; count > 0; ++level) {
    if (levels_.size() <= level) levels_.emplace_back();
    levels_[level].assign(count, empty_box());
    for (std::size_t n = 0; level == 0 && n < count; ++n) levels_[0][n] = boxes[order_[n].box];
    if (level > 0)
      for (std::size_t n = 0; n < levels_[level - 1].size(); ++n)
        levels_[level][n / k_fan] = box_around(levels_[level][n / k_fan], levels_[level - 1][n]);
    if (count <= k_fan) {
      ++level;
      break;
    }
    count = (count + k_fan - 1) / k_fan;
  }
  levels_.resize(level);
}

std::size_t BoxTree::bytes() const {
  std::size_t sum = order_.capacity() * sizeof(Place);
  for (const std::vector<Aabb>& level : levels_) sum += level.capacity() * sizeof(Aabb);
  return sum;
}

}  // namespace mallow

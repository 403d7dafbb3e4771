#include "core/bounds.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/port.h"

namespace mallow {
using MALLOW_LEVEL::load_quad, MALLOW_LEVEL::Quad;

Aabb empty_box() {
  return {Vec3::Constant(HUGE_VALF), Vec3::Constant(-HUGE_VALF)};
}

Aabb box_around(const Aabb& a, const Aabb& b) {
  return {a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
}

bool is_near(const Vec3& x, const Aabb& box, float reach) {
  return (x.array() >= box.min.array() - reach).all() && (x.array() <= box.max.array() + reach).all();
}

bool are_near(const Aabb& a, const Aabb& b, float reach) {
  return (a.min.array() <= b.max.array() + reach).all() && (b.min.array() <= a.max.array() + reach).all();
}

Aabb box_around(const VectorColumn& points, std::size_t begin, std::size_t end) {
  Aabb box;
  for (std::size_t a = 0; a < 3; ++a) {
    const float* const values = points.axis(a);
    float low = HUGE_VALF, high = -HUGE_VALF;
    // Four by four: in any order the smallest and the largest are the same. What is no number is passed over.
    Quad lows = Quad{} + low, highs = Quad{} + high;
    std::size_t i = begin;
    for (; i + 4 <= end; i += 4) {
      const Quad four = load_quad(values + i);
      lows = four < lows ? four : lows;
      highs = four > highs ? four : highs;
    }
    for (; i < end; ++i) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    for (std::size_t l = 0; l < 4; ++l) {
      low = std::min(low, lows[l]);
      high = std::max(high, highs[l]);
    }
    box.min[static_cast<int>(a)] = low;
    box.max[static_cast<int>(a)] = high;
  }
  return box;
}

Aabb bounds_of(const VectorColumn& points, std::size_t begin, std::size_t end, const Threads& threads,
               std::vector<Aabb>& partial) {
  return parallel_reduce(
      threads, end - begin, partial, empty_box(),
      [&](std::size_t first, std::size_t last) { return box_around(points, begin + first, begin + last); },
      [](const Aabb& a, const Aabb& b) { return box_around(a, b); });
}

}  // namespace mallow

#include "core/bounds.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/parallel.h"

namespace mallow {
namespace {

using Quad = float __attribute__((vector_size(16)));

}  // namespace

Aabb bounds_of(const VectorColumn& points, std::size_t begin, std::size_t end, const Threads& threads,
               std::vector<Aabb>& partial) {
  const Aabb none{Vec3::Constant(HUGE_VALF), Vec3::Constant(-HUGE_VALF)};
  return parallel_reduce(
      threads, end - begin, partial, none,
      [&](std::size_t first, std::size_t last) {
        Aabb box = none;
        for (std::size_t a = 0; a < 3; ++a) {
          const float* const values = points.axis(a) + begin;
          float low = HUGE_VALF, high = -HUGE_VALF;
          // Four by four: in any order the smallest and the largest are the same. What is no number is passed
          // over.
          Quad lows = Quad{} + low, highs = Quad{} + high;
          std::size_t i = first;
          for (; i + 4 <= last; i += 4) {
            Quad four;
            std::memcpy(&four, values + i, sizeof four);
            lows = four < lows ? four : lows;
            highs = four > highs ? four : highs;
          }
          for (; i < last; ++i) {
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
      },
      [](const Aabb& a, const Aabb& b) {
        return Aabb{a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
      });
}

}  // namespace mallow

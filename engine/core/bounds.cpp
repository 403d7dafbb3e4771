#include "core/bounds.h"

#include <cmath>

#include "core/parallel.h"

namespace mallow {

Aabb bounds_of(const VectorColumn& points, std::size_t begin, std::size_t end, int threads,
               std::vector<Aabb>& partial) {
  const Aabb none{Vec3::Constant(HUGE_VALF), Vec3::Constant(-HUGE_VALF)};
  return parallel_reduce(
      threads, end - begin, partial, none,
      [&](std::size_t first, std::size_t last) {
        Aabb box = none;
        for (std::size_t a = 0; a < 3; ++a) {
          const float* const values = points.axis(a) + begin;
          float low = HUGE_VALF, high = -HUGE_VALF;
          // In any order: the smallest and the largest of numbers are the same. What is none is passed over.
#pragma omp simd reduction(min : low) reduction(max : high)
          for (std::size_t i = first; i < last; ++i) {
            low = values[i] < low ? values[i] : low;
            high = values[i] > high ? values[i] : high;
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

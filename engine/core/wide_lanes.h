#pragma once

#include "core/cluster_lanes.h"

/// Two clusters in one register, where there are such registers: two rows or planes of points that the same
/// is done to. `Wide` is what a row is where there are none, so that one loop serves both. Each lane rounds
/// like a float: the bits are those of two clusters.
namespace mallow::MALLOW_LEVEL {

#ifdef __AVX512F__
inline constexpr std::size_t k_wide = 2;  ///< clusters in a Wide
using Wide = VectorOf<float, k_wide * k_cluster>;
using WideInts = VectorOf<std::int32_t, k_wide * k_cluster>;

// With a mask of all lanes: GCC 12 takes what the plain ones return for not set.
MALLOW_INLINE Wide larger(const Wide& a, const Wide& b) {
  return reinterpret_cast<Wide>(
      _mm512_maskz_max_ps(0xFFFF, reinterpret_cast<__m512>(a), reinterpret_cast<__m512>(b)));
}
MALLOW_INLINE Wide smaller(const Wide& a, const Wide& b) {
  return reinterpret_cast<Wide>(
      _mm512_maskz_min_ps(0xFFFF, reinterpret_cast<__m512>(a), reinterpret_cast<__m512>(b)));
}
MALLOW_INLINE Wide square_root(const Wide& value) {
  return reinterpret_cast<Wide>(_mm512_maskz_sqrt_ps(0xFFFF, reinterpret_cast<__m512>(value)));
}
MALLOW_INLINE WideInts is_larger(const Wide& a, const Wide& b) {
  return a > b;
}
MALLOW_INLINE Wide where(const WideInts& mask, const Wide& value) {
  return reinterpret_cast<Wide>(reinterpret_cast<WideInts>(value) & mask);
}
MALLOW_INLINE Wide both(const Floats& low, const Floats& high) {
  return shuffled<0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15>(low, high);
}
MALLOW_INLINE void store(const Wide& value, float* to) {
  copy_bytes(to, &value, sizeof value);
}
#else
inline constexpr std::size_t k_wide = 1;
using Wide = Floats;
#endif

}  // namespace mallow::MALLOW_LEVEL

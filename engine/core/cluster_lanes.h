#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

#ifdef __SSE__
#include <immintrin.h>
#endif

/// A cluster as one value, a lane a particle, at every level (core/lanes.h has what follows the registers).
/// For kernel files only: everything here lives in the level's own namespace, so that the linker keeps each
/// level's copy apart. Arithmetic, comparisons and `?:` are the compiler's own on vector types; it splits
/// them where registers are narrower. Each lane rounds like a float.
namespace mallow::MALLOW_LEVEL {

using Floats = float __attribute__((vector_size(k_cluster * sizeof(float))));
using Ints = int __attribute__((vector_size(k_cluster * sizeof(int))));

#define MALLOW_INLINE [[gnu::always_inline]] static inline

MALLOW_INLINE Floats load(const float* from) {
  Floats value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}
MALLOW_INLINE void store(const Floats& value, float* to) {
  __builtin_memcpy(to, &value, sizeof value);
}
MALLOW_INLINE Floats all(float value) {
  return Floats{} + value;
}
/// The larger of two numbers, `b` where one is not a number.
MALLOW_INLINE Floats larger(const Floats& a, const Floats& b) {
  // By name where there is an instruction: GCC 12 compares and blends.
#if defined(__AVX__)
  return reinterpret_cast<Floats>(_mm256_max_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#else
  return a > b ? a : b;
#endif
}
/// Zero where the mask is.
MALLOW_INLINE Floats where(const Ints& mask, const Floats& value) {
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(value) & mask);
}
/// Whether the mask is set in any lane.
MALLOW_INLINE bool any(const Ints& mask) {
#if defined(__AVX__)
  return _mm256_movemask_ps(reinterpret_cast<__m256>(mask)) != 0;
#else
  const Ints folded = mask | __builtin_shufflevector(mask, mask, 4, 5, 6, 7, 0, 1, 2, 3);
  long long parts[2];
  __builtin_memcpy(parts, &folded, sizeof parts);
  return (parts[0] | parts[1]) != 0;
#endif
}
MALLOW_INLINE Floats square_root(const Floats& value) {
  Floats root;
#if defined(__AVX__)
  root = reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(value)));
#elif defined(__SSE__)
  __m128 half[2];
  __builtin_memcpy(half, &value, sizeof value);
  half[0] = _mm_sqrt_ps(half[0]);
  half[1] = _mm_sqrt_ps(half[1]);
  __builtin_memcpy(&root, half, sizeof root);
#else
  for (std::size_t l = 0; l < k_cluster; ++l) root[l] = __builtin_sqrtf(value[l]);
#endif
  return root;
}

}  // namespace mallow::MALLOW_LEVEL

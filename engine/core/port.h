#pragma once

// What the compiler and the machine have beyond C++: vector types and what is done to them, a few words about
// bits, a pause, the levels that a processor has. core/lanes.h says what a port of the lanes is.
//
// The vector types are those of GCC, which Clang and clang-cl have too. All functions are inlined wherever
// they are called, at any optimisation, so that files of lanes may include this (core/isa.h).
#include <cstddef>
#include <cstdint>

#include "core/isa.h"

#define MALLOW_INLINE [[gnu::always_inline]] static inline

namespace mallow::MALLOW_LEVEL {

/// n numbers as one value, with the operators of one; comparisons give masks, `mask ? a : b` chooses lane by
/// lane.
template <class T, std::size_t n>
using VectorOf __attribute__((vector_size(n * sizeof(T)))) = T;
using Quad = VectorOf<float, 4>;
using QuadInts = VectorOf<std::int32_t, 4>;

/// Lanes of two vectors in any order: those of b are counted on from those of a.
template <int... at, class V>
MALLOW_INLINE auto shuffled(const V& a, const V& b) {
  return __builtin_shufflevector(a, b, at...);
}
template <int... at, class V>
MALLOW_INLINE auto shuffled(const V& v) {
  return __builtin_shufflevector(v, v, at...);
}
/// Each lane as a number of another kind, as static_cast makes it.
template <class To, class From>
MALLOW_INLINE To converted(const From& lanes) {
  return __builtin_convertvector(lanes, To);
}

MALLOW_INLINE void copy_bytes(void* to, const void* from, std::size_t bytes) {
  __builtin_memcpy(to, from, bytes);
}
MALLOW_INLINE void clear_bytes(void* to, std::size_t bytes) {
  __builtin_memset(to, 0, bytes);
}
/// Tells the processor that what is there will be read.
MALLOW_INLINE void fetch_ahead(const void* from) {
  __builtin_prefetch(from);
}

MALLOW_INLINE Quad load_quad(const float* from) {
  Quad quad;
  copy_bytes(&quad, from, sizeof quad);
  return quad;
}
MALLOW_INLINE void store_quad(const Quad& quad, float* to) {
  copy_bytes(to, &quad, sizeof quad);
}

constexpr float k_infinity = __builtin_inff();
constexpr float k_not_a_number = __builtin_nanf("");
MALLOW_INLINE float root(float value) {
  return __builtin_sqrtf(value);
}

/// How many bits are set.
MALLOW_INLINE int count_bits(std::uint32_t bits) {
  return __builtin_popcount(bits);
}
MALLOW_INLINE int count_bits(std::uint64_t bits) {
  return __builtin_popcountll(bits);
}
/// The lowest and the highest bit that is set, of which there must be one.
MALLOW_INLINE int first_bit(std::uint32_t bits) {
  return __builtin_ctz(bits);
}
MALLOW_INLINE int first_bit(std::uint64_t bits) {
  return __builtin_ctzll(bits);
}
MALLOW_INLINE int last_bit(std::uint64_t bits) {
  return 63 - __builtin_clzll(bits);
}

}  // namespace mallow::MALLOW_LEVEL

namespace mallow {

/// A pause within a loop that waits for another thread.
MALLOW_INLINE void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb");  // waits about as long as x86's pause; yield is a no-op on most
#endif
}

/// Whether this machine has the instructions of a level.
MALLOW_INLINE bool machine_has(InstructionLevel level) {
#ifdef MALLOW_X86_LEVELS
  if (level == InstructionLevel::v4)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
  if (level == InstructionLevel::v3)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
#endif
  return level == InstructionLevel::baseline;
}

}  // namespace mallow

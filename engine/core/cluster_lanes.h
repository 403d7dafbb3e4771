#pragma once

#include "core/isa.h"
#include "core/lane_vec3.h"
#include "core/raw_columns.h"

#ifdef __SSE__
#include <immintrin.h>
#endif

/// A cluster as one value, a lane a particle, at every level (core/lanes.h has what follows the registers).
/// For files of lanes only: everything here lives in the level's own namespace, so that the linker keeps each
/// level's copy apart. Arithmetic, comparisons and `?:` are the compiler's own on vector types; it splits
/// them where registers are narrower. Each lane rounds like a float.
namespace mallow::MALLOW_LEVEL {

using Floats = VectorOf<float, k_cluster>;
using Ints = VectorOf<std::int32_t, k_cluster>;
using ClusterVec3 = Vec3Of<Floats>;

/// Numbers of the lanes.
constexpr Ints k_count = {0, 1, 2, 3, 4, 5, 6, 7};

MALLOW_INLINE Floats load(const float* from) {
  Floats value;
  copy_bytes(&value, from, sizeof value);
  return value;
}
MALLOW_INLINE Ints load(const std::uint32_t* from) {
  Ints values;
  copy_bytes(&values, from, sizeof values);
  return values;
}
MALLOW_INLINE Ints load(const std::uint16_t* from) {
  using Shorts = VectorOf<std::uint16_t, k_cluster>;
  Shorts values;
  copy_bytes(&values, from, sizeof values);
  return converted<Ints>(values);
}
MALLOW_INLINE ClusterVec3 load(const ConstVectors& from, std::size_t first) {
  return {load(from.x + first), load(from.y + first), load(from.z + first)};
}
/// x_j − x_i of eight i: this way round, what a register has no room for is subtracted from memory.
MALLOW_INLINE ClusterVec3 difference(const ConstVectors& of, std::size_t j, const ClusterVec3& i) {
  return {of.x[j] - i.x, of.y[j] - i.y, of.z[j] - i.z};
}
/// Components `stride` floats apart.
MALLOW_INLINE ClusterVec3 load(const float* from, std::size_t stride) {
  return {load(from), load(from + stride), load(from + 2 * stride)};
}
MALLOW_INLINE void store(const Floats& value, float* to) {
  copy_bytes(to, &value, sizeof value);
}
MALLOW_INLINE void store(const ClusterVec3& v, float* to, std::size_t stride) {
  store(v.x, to);
  store(v.y, to + stride);
  store(v.z, to + 2 * stride);
}
MALLOW_INLINE void store(const Ints& values, std::uint32_t* to) {
  copy_bytes(to, &values, sizeof values);
}
MALLOW_INLINE Floats all(float value) {
  return Floats{} + value;
}
#if defined(__SSE__) && !defined(__AVX__)
/// What GCC 12 has no words for where registers hold half of the lanes: it would take them one by one.
struct Halves {
  __m128 low, high;
};
MALLOW_INLINE Halves halves(const Floats& value) {
  Halves parts;
  copy_bytes(&parts, &value, sizeof parts);
  return parts;
}
MALLOW_INLINE Floats joined(const Halves& parts) {
  Floats value;
  copy_bytes(&value, &parts, sizeof value);
  return value;
}
#endif

/// The larger of two numbers, `b` where one is not a number.
MALLOW_INLINE Floats larger(const Floats& a, const Floats& b) {
#if defined(__AVX__)
  return reinterpret_cast<Floats>(_mm256_max_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#elif defined(__SSE__)
  const Halves x = halves(a), y = halves(b);
  return joined({_mm_max_ps(x.low, y.low), _mm_max_ps(x.high, y.high)});
#else
  return a > b ? a : b;
#endif
}
/// The smaller of two numbers, `b` where one is not a number.
MALLOW_INLINE Floats smaller(const Floats& a, const Floats& b) {
#if defined(__AVX__)
  return reinterpret_cast<Floats>(_mm256_min_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#elif defined(__SSE__)
  const Halves x = halves(a), y = halves(b);
  return joined({_mm_min_ps(x.low, y.low), _mm_min_ps(x.high, y.high)});
#else
  return a < b ? a : b;
#endif
}
/// The smallest of eight values in every lane.
MALLOW_INLINE Floats smallest(Floats v) {
  const Floats by_four = shuffled<4, 5, 6, 7, 0, 1, 2, 3>(v);
  v = smaller(v, by_four);
  const Floats by_two = shuffled<2, 3, 0, 1, 6, 7, 4, 5>(v);
  v = smaller(v, by_two);
  const Floats by_one = shuffled<1, 0, 3, 2, 5, 4, 7, 6>(v);
  return smaller(v, by_one);
}
/// Where a number is larger than another.
MALLOW_INLINE Ints is_larger(const Floats& a, const Floats& b) {
#if defined(__SSE__) && !defined(__AVX__)
  const Halves x = halves(a), y = halves(b);
  return reinterpret_cast<Ints>(joined({_mm_cmplt_ps(y.low, x.low), _mm_cmplt_ps(y.high, x.high)}));
#else
  return a > b;
#endif
}
/// Where a number is at most another.
MALLOW_INLINE Ints is_at_most(const Floats& a, const Floats& b) {
#if defined(__SSE__) && !defined(__AVX__)
  const Halves x = halves(a), y = halves(b);
  return reinterpret_cast<Ints>(joined({_mm_cmple_ps(x.low, y.low), _mm_cmple_ps(x.high, y.high)}));
#else
  return a <= b;
#endif
}
/// Where a number is another one.
MALLOW_INLINE Ints is_equal(const Ints& a, int b) {
#if defined(__SSE__) && !defined(__AVX__)
  __m128i parts[2];
  copy_bytes(parts, &a, sizeof parts);
  for (__m128i& part : parts) part = _mm_cmpeq_epi32(part, _mm_set1_epi32(b));
  Ints mask;
  copy_bytes(&mask, parts, sizeof mask);
  return mask;
#else
  return a == b;
#endif
}
/// Zero where the mask is.
MALLOW_INLINE Floats where(const Ints& mask, const Floats& value) {
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(value) & mask);
}
MALLOW_INLINE ClusterVec3 where(const Ints& mask, const ClusterVec3& v) {
  return {where(mask, v.x), where(mask, v.y), where(mask, v.z)};
}
/// Bit l is that of lane l.
MALLOW_INLINE unsigned bits(const Ints& mask) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#elif defined(__SSE__)
  const Halves parts = halves(reinterpret_cast<Floats>(mask));
  return static_cast<unsigned>(_mm_movemask_ps(parts.low) | _mm_movemask_ps(parts.high) << 4);
#else
  unsigned result = 0;
  for (std::size_t l = 0; l < k_cluster; ++l) result |= (mask[l] != 0 ? 1u : 0u) << l;
  return result;
#endif
}
/// Of the mask the bits of the first `count` lanes.
MALLOW_INLINE unsigned bits_of(const Ints& mask, std::size_t count) {
  return bits(mask) & ((1u << (count < k_cluster ? count : k_cluster)) - 1);
}
/// Whether the mask is set in any lane.
MALLOW_INLINE bool any(const Ints& mask) {
#if defined(__SSE__) && !defined(__AVX__)
  const Halves parts = halves(reinterpret_cast<Floats>(mask));
  return _mm_movemask_ps(_mm_or_ps(parts.low, parts.high)) != 0;
#else
  return bits(mask) != 0;
#endif
}
MALLOW_INLINE Floats square_root(const Floats& value) {
#if defined(__AVX__)
  return reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(value)));
#elif defined(__SSE__)
  const Halves parts = halves(value);
  return joined({_mm_sqrt_ps(parts.low), _mm_sqrt_ps(parts.high)});
#else
  Floats roots;
  for (std::size_t l = 0; l < k_cluster; ++l) roots[l] = root(value[l]);
  return roots;
#endif
}

#ifdef MALLOW_NATIVE
/// 1/√value, value > 0, right to 12 bits or, with AVX-512, 14: for Arithmetic::native alone.
MALLOW_INLINE Floats rough_inverse_root(const Floats& value) {
#ifdef __AVX512VL__
  return reinterpret_cast<Floats>(_mm256_rsqrt14_ps(reinterpret_cast<__m256>(value)));
#else
  return reinterpret_cast<Floats>(_mm256_rsqrt_ps(reinterpret_cast<__m256>(value)));
#endif
}
#endif

/// Transposes both 4 x 4 halves: lane 4 g + t of vector c becomes lane 4 g + c of vector t.
MALLOW_INLINE void transpose_halves(Floats* v) {
#if defined(__SSE__) && !defined(__AVX__)
  Halves rows[4];
  for (int c = 0; c < 4; ++c) rows[c] = halves(v[c]);
  _MM_TRANSPOSE4_PS(rows[0].low, rows[1].low, rows[2].low, rows[3].low);
  _MM_TRANSPOSE4_PS(rows[0].high, rows[1].high, rows[2].high, rows[3].high);
  for (int c = 0; c < 4; ++c) v[c] = joined(rows[c]);
#else
  const Floats a = shuffled<0, 8, 1, 9, 4, 12, 5, 13>(v[0], v[1]);
  const Floats b = shuffled<0, 8, 1, 9, 4, 12, 5, 13>(v[2], v[3]);
  const Floats c = shuffled<2, 10, 3, 11, 6, 14, 7, 15>(v[0], v[1]);
  const Floats d = shuffled<2, 10, 3, 11, 6, 14, 7, 15>(v[2], v[3]);
  v[0] = shuffled<0, 1, 8, 9, 4, 5, 12, 13>(a, b);
  v[1] = shuffled<2, 3, 10, 11, 6, 7, 14, 15>(a, b);
  v[2] = shuffled<0, 1, 8, 9, 4, 5, 12, 13>(c, d);
  v[3] = shuffled<2, 3, 10, 11, 6, 7, 14, 15>(c, d);
#endif
}
/// Eight floats from two places.
MALLOW_INLINE Floats load_halves(const float* low, const float* high) {
#if defined(__AVX__)
  return reinterpret_cast<Floats>(_mm256_loadu2_m128(high, low));
#else
  Quad halves[2];
  copy_bytes(&halves[0], low, sizeof halves[0]);
  copy_bytes(&halves[1], high, sizeof halves[1]);
  return shuffled<0, 1, 2, 3, 4, 5, 6, 7>(halves[0], halves[1]);
#endif
}
/// numbers[c]: number c of four, of the rows that eight names say, `stride` floats apart.
MALLOW_INLINE void load_named(const float* rows, std::size_t stride, const std::uint32_t* names,
                              Floats* numbers) {
  for (std::size_t t = 0; t < 4; ++t)
    numbers[t] = load_halves(rows + stride * names[t], rows + stride * names[t + 4]);
  transpose_halves(numbers);
}
/// The reverse, into eight rows of four numbers that follow each other; spoils the numbers.
MALLOW_INLINE void store_rows(Floats* numbers, float* rows) {
  transpose_halves(numbers);
  for (std::size_t t = 0; t < 4; ++t) {
    const Quad low = shuffled<0, 1, 2, 3>(numbers[t]);
    const Quad high = shuffled<4, 5, 6, 7>(numbers[t]);
    copy_bytes(rows + 4 * t, &low, sizeof low);
    copy_bytes(rows + 4 * (t + 4), &high, sizeof high);
  }
}

#ifdef __SSSE3__
/// Per mask of `lanes` lanes those that are set, in order; each as the places of `bytes` bytes.
template <unsigned lanes, unsigned bytes>
struct LaneTable {
  alignas(16) unsigned char places[1u << lanes][lanes * bytes];
};
template <unsigned lanes, unsigned bytes>
constexpr LaneTable<lanes, bytes> lane_table() {
  LaneTable<lanes, bytes> table{};
  for (unsigned mask = 0; mask < 1u << lanes; ++mask)
    for (unsigned l = 0, n = 0; l < lanes; ++l)
      if (mask >> l & 1)
        for (unsigned b = 0; b < bytes; ++b)
          table.places[mask][n++] = static_cast<unsigned char>(bytes * l + b);
  return table;
}
#ifdef __AVX2__
constexpr LaneTable<8, 1> k_lane_table = lane_table<8, 1>();
#else
constexpr LaneTable<4, 4> k_lane_table = lane_table<4, 4>();
#endif
#endif

/// Writes the values of the lanes whose bit is set, in order, and returns how many; may write k_cluster.
MALLOW_INLINE std::size_t compress(unsigned set, const Ints& values, std::uint32_t* out) {
#ifdef __AVX2__
  const __m256i lanes =
      _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(k_lane_table.places[set])));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), lanes));
#elif defined(__SSSE3__)
  const auto packed = [](const __m128i& four, unsigned part) {
    return _mm_shuffle_epi8(four,
                            _mm_load_si128(reinterpret_cast<const __m128i*>(k_lane_table.places[part])));
  };
  __m128i low, high;
  copy_bytes(&low, &values, sizeof low);
  copy_bytes(&high, reinterpret_cast<const char*>(&values) + sizeof low, sizeof high);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(out), packed(low, set & 15));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(out + count_bits(set & 15)), packed(high, set >> 4));
#else
  // Always written, kept only where the bit is: no branch to predict.
  for (std::size_t l = 0; l < k_cluster; ++l) {
    *out = static_cast<std::uint32_t>(values[l]);
    out += set >> l & 1;
  }
#endif
  return static_cast<std::size_t>(count_bits(set));
}
MALLOW_INLINE std::size_t compress(unsigned set, const Floats& values, float* out) {
  std::uint32_t packed[k_cluster];
  const std::size_t count = compress(set, reinterpret_cast<Ints>(values), packed);
  copy_bytes(out, packed, sizeof packed);
  return count;
}

}  // namespace mallow::MALLOW_LEVEL

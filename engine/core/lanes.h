#pragma once

// Vectors of the widest registers of an instruction level, for files of lanes. Whoever works lane by lane in
// them, each lane on its own, gets the same bits at every level: the width only says how many lanes go at
// once.
//
// A port of the lanes is this header and what it stands on: core/port.h, which has the compiler's vector
// types and words, and beside it core/cluster_lanes.h and core/wide_lanes.h, of clusters. No other file of
// the engine names a vector type, an intrinsic or a builtin of a compiler (core:a_port_is_four_headers). They
// have plain C++ where a machine has no intrinsics (tools/check_arm builds it so); for a compiler without
// vector types, VectorOf is to be a class with their operators.
//
// Everything here is in an anonymous namespace of the level, so that no level's code can stand in for
// another's (core/isa.h).
#include "core/isa.h"
#include "core/lane_vec3.h"
#include "core/raw_columns.h"

namespace mallow::MALLOW_LEVEL {
namespace {

#if defined(__AVX512F__)
#define MALLOW_WIDTH 16
#elif defined(__AVX__)
#define MALLOW_WIDTH 8
#else
#define MALLOW_WIDTH 4
#endif
constexpr std::size_t k_width = MALLOW_WIDTH;
static_assert(k_lanes % k_width == 0);

using Lanes = VectorOf<float, k_width>;
/// All bits of a lane are set or none; what comparisons give and `mask ? a : b` takes.
using LaneMask = VectorOf<std::int32_t, k_width>;
using LaneBytes = VectorOf<std::uint8_t, k_width>;

using LaneVec3 = Vec3Of<Lanes>;

inline Lanes smaller(const Lanes& a, const Lanes& b) {
  return b < a ? b : a;
}
inline Lanes larger(const Lanes& a, const Lanes& b) {
  return b > a ? b : a;
}
inline LaneVec3 smaller(const LaneVec3& a, const LaneVec3& b) {
  return {smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)};
}
inline LaneVec3 larger(const LaneVec3& a, const LaneVec3& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}

inline Lanes load(const float* from) {
  Lanes lanes;
  copy_bytes(&lanes, from, sizeof lanes);
  return lanes;
}
inline void store(const Lanes& lanes, float* to) {
  copy_bytes(to, &lanes, sizeof lanes);
}
/// The same for the first `count` <= k_width lanes, where no more lie in memory; the others repeat the first.
inline Lanes load_some(const float* from, std::size_t count) {
  float values[k_width];
  for (std::size_t l = 0; l < k_width; ++l) values[l] = from[l < count ? l : 0];
  return load(values);
}
inline void store_some(const Lanes& lanes, std::size_t count, float* to) {
  copy_bytes(to, &lanes, count * sizeof(float));
}
inline Lanes all_lanes(float value) {
  return Lanes{} + value;
}
/// Of three floats.
inline LaneVec3 all_lanes(const float* v) {
  return {all_lanes(v[0]), all_lanes(v[1]), all_lanes(v[2])};
}

/// The square root of each lane; a loop that compilers make one instruction.
inline Lanes square_root(Lanes lanes) {
  float values[k_width];
  copy_bytes(values, &lanes, sizeof lanes);
  for (std::size_t l = 0; l < k_width; ++l) values[l] = root(values[l]);
  copy_bytes(&lanes, values, sizeof lanes);
  return lanes;
}

/// Bit l is that of lane l.
inline unsigned bits(const LaneMask& mask) {
#if MALLOW_WIDTH == 4 && defined(__SSE__)
  return static_cast<unsigned>(__builtin_ia32_movmskps((Lanes)mask));
#elif MALLOW_WIDTH == 8
  return static_cast<unsigned>(__builtin_ia32_movmskps256((Lanes)mask));
#elif MALLOW_WIDTH == 16
  const Lanes lanes = (Lanes)mask;
  const auto low = shuffled<0, 1, 2, 3, 4, 5, 6, 7>(lanes);
  const auto high = shuffled<8, 9, 10, 11, 12, 13, 14, 15>(lanes);
  return static_cast<unsigned>(__builtin_ia32_movmskps256(low)) |
         static_cast<unsigned>(__builtin_ia32_movmskps256(high)) << 8;
#else
  unsigned result = 0;
  for (std::size_t l = 0; l < k_width; ++l) result |= (mask[l] != 0 ? 1u : 0u) << l;
  return result;
#endif
}
inline bool any(const LaneMask& mask) {
  return bits(mask) != 0;
}

/// 1 where the mask is set.
inline LaneBytes bytes(const LaneMask& mask) {
  return converted<LaneBytes>(mask & 1);
}

// Shuffles within each four lanes, named as x86 names them.
#if MALLOW_WIDTH == 4
#define MALLOW_UNPACK_LOW 0, 4, 1, 5
#define MALLOW_UNPACK_HIGH 2, 6, 3, 7
#define MALLOW_PAIR_LOW 0, 1, 4, 5
#define MALLOW_PAIR_HIGH 2, 3, 6, 7
#elif MALLOW_WIDTH == 8
#define MALLOW_UNPACK_LOW 0, 8, 1, 9, 4, 12, 5, 13
#define MALLOW_UNPACK_HIGH 2, 10, 3, 11, 6, 14, 7, 15
#define MALLOW_PAIR_LOW 0, 1, 8, 9, 4, 5, 12, 13
#define MALLOW_PAIR_HIGH 2, 3, 10, 11, 6, 7, 14, 15
#else
#define MALLOW_UNPACK_LOW 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29
#define MALLOW_UNPACK_HIGH 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31
#define MALLOW_PAIR_LOW 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29
#define MALLOW_PAIR_HIGH 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31
#endif

/// Transposes every 4 x 4 block: lane 4 g + t of vector c becomes lane 4 g + c of vector t.
inline void transpose_fours(Lanes* v) {
  const Lanes a = shuffled<MALLOW_UNPACK_LOW>(v[0], v[1]);
  const Lanes b = shuffled<MALLOW_UNPACK_LOW>(v[2], v[3]);
  const Lanes c = shuffled<MALLOW_UNPACK_HIGH>(v[0], v[1]);
  const Lanes d = shuffled<MALLOW_UNPACK_HIGH>(v[2], v[3]);
  v[0] = shuffled<MALLOW_PAIR_LOW>(a, b);
  v[1] = shuffled<MALLOW_PAIR_HIGH>(a, b);
  v[2] = shuffled<MALLOW_PAIR_LOW>(c, d);
  v[3] = shuffled<MALLOW_PAIR_HIGH>(c, d);
}

/// Lanes 4 g to 4 g + 3 are the four floats at from + 4 g stride.
inline Lanes load_quads(const float* from, [[maybe_unused]] std::size_t stride) {
#if MALLOW_WIDTH == 4
  return load_quad(from);
#else
  const auto eight = [](const Quad& a, const Quad& b) { return shuffled<0, 1, 2, 3, 4, 5, 6, 7>(a, b); };
  const auto low = eight(load_quad(from), load_quad(from + 4 * stride));
#if MALLOW_WIDTH == 8
  return low;
#else
  const auto high = eight(load_quad(from + 8 * stride), load_quad(from + 12 * stride));
  return shuffled<0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15>(low, high);
#endif
#endif
}
inline void store_quads(const Lanes& v, float* to, [[maybe_unused]] std::size_t stride) {
  store_quad(shuffled<0, 1, 2, 3>(v), to);
#if MALLOW_WIDTH >= 8
  store_quad(shuffled<4, 5, 6, 7>(v), to + 4 * stride);
#endif
#if MALLOW_WIDTH == 16
  store_quad(shuffled<8, 9, 10, 11>(v), to + 8 * stride);
  store_quad(shuffled<12, 13, 14, 15>(v), to + 12 * stride);
#endif
}

/// numbers[c]: number c of k_width rows that lie `stride` floats apart. Numbers come in fours.
inline void load_transposed(const float* rows, std::size_t stride, std::size_t count, Lanes* numbers) {
  for (std::size_t c = 0; c < count; c += 4) {
    for (std::size_t t = 0; t < 4; ++t) numbers[c + t] = load_quads(rows + t * stride + c, stride);
    transpose_fours(numbers + c);
  }
}
/// The reverse; spoils the numbers.
inline void store_transposed(Lanes* numbers, std::size_t count, std::size_t stride, float* rows) {
  for (std::size_t c = 0; c < count; c += 4) {
    transpose_fours(numbers + c);
    for (std::size_t t = 0; t < 4; ++t) store_quads(numbers[c + t], rows + t * stride + c, stride);
  }
}

/// k_width rows from one on, or the rest of a block. The rest is loaded float by float: what lies behind it
/// may be another thread's, or nobody's.
struct WholeRows {
  static constexpr std::size_t count = k_width;
  std::size_t row;
  Lanes get(const float* column) const { return load(column + row); }
  void put(const Lanes& lanes, float* column) const { store(lanes, column + row); }
  unsigned valid(unsigned bits) const { return bits; }
};
struct LastRows {
  std::size_t row, count;
  Lanes get(const float* column) const { return load_some(column + row, count); }
  void put(const Lanes& lanes, float* column) const { store_some(lanes, count, column + row); }
  unsigned valid(unsigned bits) const { return bits & ((1u << count) - 1); }
};

/// Calls body(rows) for the rows [begin, end).
template <class Body>
void for_rows(std::size_t begin, std::size_t end, const Body& body) {
  std::size_t i = begin;
  for (; i + k_width <= end; i += k_width) body(WholeRows{i});
  if (i < end) body(LastRows{i, end - i});
}

template <class Rows>
LaneVec3 get(const Rows& rows, const ConstVectors& columns) {
  return {rows.get(columns.x), rows.get(columns.y), rows.get(columns.z)};
}
template <class Rows>
void put(const Rows& rows, const LaneVec3& v, const Vectors& columns) {
  rows.put(v.x, columns.x);
  rows.put(v.y, columns.y);
  rows.put(v.z, columns.z);
}
}  // namespace
}  // namespace mallow::MALLOW_LEVEL

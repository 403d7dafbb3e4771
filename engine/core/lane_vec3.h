#pragma once

// Vectors of three components, each of them lanes: those of core/lanes.h or of core/cluster_lanes.h, which
// include this. Operators work component by component; a float is the same in every lane.
//
// Floating-point sums have an order, and with it their bits: dot() adds the last two terms first, as Eigen
// does, dot_from_left() the first two.
#include "core/port.h"

namespace mallow::MALLOW_LEVEL {
namespace {

template <class L>
struct Vec3Of {
  L x, y, z;
};

template <class L>
MALLOW_INLINE Vec3Of<L> operator-(const Vec3Of<L>& v) {
  return {-v.x, -v.y, -v.z};
}
template <class L>
MALLOW_INLINE Vec3Of<L> operator+(const Vec3Of<L>& a, const Vec3Of<L>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class L>
MALLOW_INLINE Vec3Of<L> operator-(const Vec3Of<L>& a, const Vec3Of<L>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// factor: lanes, or a float.
template <class Factor, class L>
MALLOW_INLINE Vec3Of<L> operator*(const Factor& factor, const Vec3Of<L>& v) {
  return {factor * v.x, factor * v.y, factor * v.z};
}
template <class L, class Divisor>
MALLOW_INLINE Vec3Of<L> operator/(const Vec3Of<L>& v, const Divisor& divisor) {
  return {v.x / divisor, v.y / divisor, v.z / divisor};
}
template <class L>
MALLOW_INLINE void operator+=(Vec3Of<L>& sum, const Vec3Of<L>& v) {
  sum = sum + v;
}

template <class L>
MALLOW_INLINE L dot(const Vec3Of<L>& a, const Vec3Of<L>& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
template <class L>
MALLOW_INLINE L dot_from_left(const Vec3Of<L>& a, const Vec3Of<L>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// |v|²
template <class L>
MALLOW_INLINE L squared(const Vec3Of<L>& v) {
  return dot(v, v);
}
/// a where the mask is set, else b.
template <class Mask, class L>
MALLOW_INLINE Vec3Of<L> select(const Mask& mask, const Vec3Of<L>& a, const Vec3Of<L>& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}

}  // namespace
}  // namespace mallow::MALLOW_LEVEL

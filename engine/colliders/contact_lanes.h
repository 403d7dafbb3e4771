#pragma once

// What lanes do with any shape: the distances that tell which rows may touch it, and contact of model 2,
// section 4 A. Each lane is a particle; a single one goes the same way. A shape's own file, `box_lanes.cpp`
// and the like, has a class as
//
//   struct BoxLanes {
//     explicit BoxLanes(const ShapeNumbers&);
//     Meets meets() const;                        // how a particle on its way finds the plane that it meets
//     Surface nearest(const LaneVec3& x) const;   // signed distance and its gradient
//     LaneMask is_near(const LaneVec3& x, const Lanes& reach) const;  // not farther than reach; cheap
//     static float least_distance(const ShapeNumbers&, const float* min, const float* max);
//     float flat_way() const;  // only of what may be hollow: a way along it that meets nothing more of it
//   };
//
// and makes its table of it: lanes_of<BoxLanes>().
//
// symbol  | here             | unit | where
// x, v    | x, v             | m, m/s | particle; v is blended, before contact
// v^t     | before           | m/s  | at the start of the step
// u, Ω    | ContactSurface   | m/s, 1/s | of the collider
// d, n    | Surface          | m, 1 | distance of x from the plane that is met, and its normal
#include "colliders/collider_lanes.h"
#include "core/lanes.h"
#include "shapes/norm_range.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// As SurfacePoint has them.
struct Surface {
  Lanes distance;
  LaneVec3 normal;
};

/// Where a particle on its way of one step meets a shape: in the plane that the shape is; on the way, which
/// steps along that are as long as the shape is far; where the way ends, as a fast particle may cross a
/// hollow in one step.
enum class Meets { here, on_the_way, at_the_end };

/// Looks that a way takes to find where it meets a convex shape, at most, and the share of the way that is
/// near enough. Each look goes on by the distance that is left, so it stops short of the shape; the plane
/// that is met there stands before all of the shape, so what is left can only be a particle that stops short
/// by less than that share, where it comes along a surface that is bent.
constexpr int k_most_looks = 16;
constexpr float k_near_enough = 1.0f / 64;

/// The least length that has a direction.
constexpr float k_no_length = __FLT_MIN__;

/// M v, and Mᵀ v, of a matrix that lies row by row.
inline LaneVec3 product(const float* m, const LaneVec3& v) {
  return {m[0] * v.x + (m[1] * v.y + m[2] * v.z), m[3] * v.x + (m[4] * v.y + m[5] * v.z),
          m[6] * v.x + (m[7] * v.y + m[8] * v.z)};
}
inline LaneVec3 transposed_product(const float* m, const LaneVec3& v) {
  return {m[0] * v.x + (m[3] * v.y + m[6] * v.z), m[1] * v.x + (m[4] * v.y + m[7] * v.z),
          m[2] * v.x + (m[5] * v.y + m[8] * v.z)};
}

/// |v|, also where a float does not hold the square of it.
inline Lanes norm(const LaneVec3& v) {
  const Lanes square = squared(v), length = square_root(square);
  const LaneMask odd = ~((square > k_least_square) & (square < k_greatest_square));
  if (!any(odd)) return length;
  const Lanes largest = larger(larger(larger(v.x, -v.x), larger(v.y, -v.y)), larger(v.z, -v.z));
  const LaneMask scales = odd & (largest > 0.0f) & (largest < k_infinity);
  return scales ? largest * square_root(squared(v / largest)) : length;
}

/// A collider that stays upright: its shapes are given where they are.
struct Upright {
  const ContactSurface& surface;
  LaneVec3 to_shape(const LaneVec3& x) const { return x; }
  LaneVec3 velocity(const LaneVec3&) const { return all_lanes(surface.velocity); }
  LaneVec3 way_to_shape(const LaneVec3& way) const { return way; }
  Surface seen(const Surface& there) const { return there; }
  Surface seen_at_end(const Surface& met) const { return met; }
  LaneVec3 velocity_under(const LaneVec3& u, const Surface&) const { return u; }
};

/// One that turns, or stands turned. A particle at x that moves by Δt v goes in its frame from R^T (x − c) by
/// R'^T Δt (v − u), with R' of the end of the step and u of the collider's point at x: what it meets there is
/// seen as it stands at the end. By normals of the start, thin blades turned through bodies.
struct Turning {
  const ContactSurface& surface;
  LaneVec3 to_shape(const LaneVec3& x) const {
    return transposed_product(surface.rotation, x - all_lanes(surface.translation));
  }
  /// Of the collider's point at x.
  LaneVec3 velocity(const LaneVec3& x) const {
    return all_lanes(surface.velocity) + product(surface.spin, x - all_lanes(surface.translation));
  }
  LaneVec3 way_to_shape(const LaneVec3& way) const { return transposed_product(surface.turned, way); }
  Surface seen(const Surface& there) const {
    return {there.distance, product(surface.rotation, there.normal)};
  }
  Surface seen_at_end(const Surface& met) const {
    return {met.distance, product(surface.turned, met.normal)};
  }
  /// Of the surface under a particle at which the collider moves with u: along the plane that is met, that
  /// of the particle's foot in it. Across it is that of u, so that a particle which sticks keeps its gap.
  LaneVec3 velocity_under(const LaneVec3& u, const Surface& met) const {
    const Lanes distance = met.distance < k_infinity ? met.distance : Lanes{};
    const LaneVec3 change = transposed_product(surface.spin, met.normal);
    return u + distance * (change - dot(change, met.normal) * met.normal);
  }
};

template <class Shape>
Surface meet(const Shape& shape, float offset, const LaneVec3& x, const LaneVec3& way) {
  if (shape.meets() == Meets::here) return shape.nearest(x);
  if (shape.meets() == Meets::at_the_end) {
    const Surface end = shape.nearest(x + way);
    return {end.distance - dot(way, end.normal), end.normal};
  }
  const Lanes length = square_root(squared(way));
  Lanes t = {};
  Surface met = shape.nearest(x);
  LaneMask apart = {}, going = t == 0.0f;
  for (int look = 0; look < k_most_looks; ++look) {
    const Lanes gap = met.distance - offset;
    going &= gap > k_near_enough * length;
    if (!any(going)) break;
    t = going ? t + gap / length : t;
    const LaneMask passes = going & ~(t < 1.0f);
    apart |= passes;
    going &= ~passes;
    const Surface next = shape.nearest(x + t * way);
    met = {going ? next.distance : met.distance, select(going, next.normal, met.normal)};
  }
  return {apart ? all_lanes(k_infinity) : met.distance - t * dot(way, met.normal), met.normal};
}

/// The normal velocity with which a particle leaves that comes with `approach`, so that it rises to e² of the
/// height that it fell from; minus infinity where it does not bounce.
inline Lanes bounce(float restitution, const Lanes& approach, const Lanes& gap, const LaneVec3& normal,
                    const ContactStep& step) {
  const Lanes none = all_lanes(-k_infinity), zero = {};
  const LaneMask bounces = approach < -step.least_bounce;
  if (!(restitution > 0) || !any(bounces)) return none;
  const Lanes gravity = larger(zero, dot(all_lanes(step.gravity), normal) * -1.0f);
  const Lanes half_kick = 0.5f * gravity * step.time_step, speed = half_kick - approach;
  const float kept = restitution * restitution;
  const Lanes square = kept * (speed * speed) - 2.0f * (1.0f - kept) * gravity * larger(gap, zero);
  return (bounces & (square > 0.0f)) ? smaller(square_root(square) - half_kick, -approach) : none;
}

/// The velocity after contact of a particle that comes with `before` (v^t), would move with v, and meets the
/// plane `met`, which moves with u. [model 2, section 4 A]
inline LaneVec3 resolve_contact(const ContactSurface& surface, LaneVec3 u, const Surface& met,
                                const ContactStep& step, const LaneVec3& before, const LaneVec3& v) {
  const LaneVec3& n = met.normal;
  if (surface.carries) {
    const LaneVec3 along = all_lanes(surface.along);
    u += along - dot(along, n) * n;
  }
  const Lanes gap = met.distance - step.contact_offset, zero = {};
  const LaneVec3 relative = v - u;
  const Lanes normal_velocity = dot(relative, n);
  const LaneMask apart = gap + step.time_step * normal_velocity >= 0.0f;
  if (!any(~apart)) return v;

  const LaneVec3 relative_before = before - u;
  const Lanes approach = dot(relative_before, n);
  const Lanes reach = -gap / step.time_step;  // just touches at the end of the step
  const Lanes target = larger(gap >= 0.0f ? reach : smaller(reach, all_lanes(step.max_push)),
                              bounce(surface.restitution, approach, gap, n, step));
  const Lanes change = target - normal_velocity;

  // Coulomb's friction takes at most what slides, and leaves what the step has turned round already.
  const LaneVec3 tangential = relative - normal_velocity * n;
  const Lanes square = squared(tangential), speed = square_root(square), one = all_lanes(1.0f);
  Lanes taken = speed > 0.0f ? smaller(one, surface.friction * change / speed) : one;
  const Lanes along = dot(tangential, relative_before - approach * n);
  taken = along < 0.0f ? smaller(taken, larger(zero, 1.0f + along / square)) : taken;
  const Lanes kept = 1.0f - taken;
  return select(apart, v, (u + target * n) + kept * tangential);
}

template <class Shape>
void nearest(const ShapeNumbers& numbers, ConstVectors position, std::size_t begin, std::size_t end,
             float* distance, Vectors normal) noexcept {
  const Shape shape(numbers);
  for_rows(begin, end, [&](auto rows) {
    const Surface s = shape.nearest(get(rows, position));
    rows.put(s.distance, distance);
    put(rows, s.normal, normal);
  });
}

template <class Shape, class Frame>
void mark_in(const Shape& shape, const Frame& frame, const ContactStep& step, ConstVectors position,
             ConstVectors velocity, float slack, std::size_t begin, std::size_t end,
             std::uint8_t* flags) noexcept {
  for_rows(begin, end, [&](auto rows) {
    const LaneVec3 x = get(rows, position);
    const LaneVec3 w = get(rows, velocity) - frame.velocity(x);
    const Lanes reach = step.contact_offset + step.time_step * square_root(squared(w));
    unsigned near = rows.valid(bits(shape.is_near(frame.to_shape(x), reach + slack)));
    for (; near != 0; near &= near - 1) flags[rows.row - begin + static_cast<unsigned>(first_bit(near))] = 1;
  });
}

template <class Shape>
void mark(const ShapeNumbers& numbers, const ContactSurface& surface, const ContactStep& step,
          ConstVectors position, ConstVectors velocity, float slack, std::size_t begin, std::size_t end,
          std::uint8_t* flags) noexcept {
  const Shape shape(numbers);
  if (surface.turns)
    mark_in(shape, Turning{surface}, step, position, velocity, slack, begin, end, flags);
  else
    mark_in(shape, Upright{surface}, step, position, velocity, slack, begin, end, flags);
}

/// Of up to k_width rows, the last repeated.
struct ListedRows {
  const std::uint32_t* rows;
  std::size_t count;
  Lanes get(const float* column) const {
    float values[k_width];
    for (std::size_t l = 0; l < k_width; ++l) values[l] = column[rows[l < count ? l : count - 1]];
    return load(values);
  }
  void put(const Lanes& lanes, float* column) const {
    for (std::size_t l = 0; l < count; ++l) column[rows[l]] = lanes[l];
  }
};

template <class Shape, class Frame>
void resolve_in(const Shape& shape, const Frame& frame, const ContactStep& step, ConstVectors position,
                ConstVectors before, const std::uint32_t* rows, std::size_t count, Vectors velocity,
                float& fastest) noexcept {
  for (std::size_t k = 0; k < count; k += k_width) {
    const ListedRows listed{rows + k, count - k < k_width ? count - k : k_width};
    const LaneVec3 x = get(listed, position);
    const LaneVec3 free = get(listed, {velocity.x, velocity.y, velocity.z});
    const LaneVec3 u = frame.velocity(x);
    const LaneVec3 way = step.time_step * (free - u);
    const Surface met =
        frame.seen_at_end(meet(shape, step.contact_offset, frame.to_shape(x), frame.way_to_shape(way)));
    LaneVec3 v =
        resolve_contact(frame.surface, frame.velocity_under(u, met), met, step, get(listed, before), free);
    if constexpr (requires { shape.flat_way(); }) {
      // What slides along one part of it may meet the next in the same step.
      const LaneVec3 slide = step.time_step * (v - u);
      if (any(squared(slide) > shape.flat_way() * shape.flat_way())) {
        const Surface next =
            frame.seen_at_end(meet(shape, step.contact_offset, frame.to_shape(x), frame.way_to_shape(slide)));
        v = resolve_contact(frame.surface, frame.velocity_under(u, next), next, step, get(listed, before), v);
      }
    }
    put(listed, v, velocity);
    const Lanes squares = squared(v);
    for (std::size_t l = 0; l < listed.count; ++l) fastest = fastest < squares[l] ? squares[l] : fastest;
  }
}

template <class Shape>
void resolve(const ShapeNumbers& numbers, const ContactSurface& surface, const ContactStep& step,
             ConstVectors position, ConstVectors before, const std::uint32_t* rows, std::size_t count,
             Vectors velocity, float& fastest) noexcept {
  const Shape shape(numbers);
  if (surface.turns)
    resolve_in(shape, Turning{surface}, step, position, before, rows, count, velocity, fastest);
  else
    resolve_in(shape, Upright{surface}, step, position, before, rows, count, velocity, fastest);
}

template <class Shape, class Frame>
void separate_in(const Shape& shape, const Frame& frame, ConstVectors position, const std::uint32_t* rows,
                 std::size_t count, float* distance, Vectors normal) noexcept {
  for (std::size_t k = 0; k < count; k += k_width) {
    const ListedRows listed{rows + k, count - k < k_width ? count - k : k_width};
    const Surface s = frame.seen(shape.nearest(frame.to_shape(get(listed, position))));
    for (std::size_t l = 0; l < listed.count; ++l) {
      distance[k + l] = s.distance[l];
      normal.x[k + l] = s.normal.x[l];
      normal.y[k + l] = s.normal.y[l];
      normal.z[k + l] = s.normal.z[l];
    }
  }
}

template <class Shape>
void separate(const ShapeNumbers& numbers, const ContactSurface& surface, ConstVectors position,
              const std::uint32_t* rows, std::size_t count, float* distance, Vectors normal) noexcept {
  const Shape shape(numbers);
  if (surface.turns)
    separate_in(shape, Turning{surface}, position, rows, count, distance, normal);
  else
    separate_in(shape, Upright{surface}, position, rows, count, distance, normal);
}

/// For shapes that are convex: their least_distance(), or, where `inside`, that of their hollow.
template <class Shape>
float least_distance_of_convex(const ShapeNumbers& numbers, bool inside, const float* min, const float* max) {
  const Shape shape(numbers);
  if (!inside) {
    // Distance to a convex shape is a convex function: it lies above each of its tangents.
    float middle[3], half[3];
    for (int k = 0; k < 3; ++k) {
      half[k] = 0.5f * max[k] - 0.5f * min[k];
      middle[k] = 0.5f * max[k] + 0.5f * min[k];
    }
    const Surface s = shape.nearest(all_lanes(middle));
    const auto drop = [](float slope, float way) { return slope < 0 ? -slope * way : slope * way; };
    return s.distance[0] -
           (drop(s.normal.x[0], half[0]) + (drop(s.normal.y[0], half[1]) + drop(s.normal.z[0], half[2])));
  }
  // In a hollow it is a concave one, which is least in a corner.
  Lanes least = all_lanes(k_infinity);
  for (std::size_t first = 0; first < 8; first += k_width) {
    float corner[3][k_width];
    for (std::size_t l = 0; l < k_width; ++l)
      for (std::size_t k = 0; k < 3; ++k) corner[k][l] = ((first + l) >> k & 1) != 0 ? max[k] : min[k];
    least = smaller(least, shape.nearest({load(corner[0]), load(corner[1]), load(corner[2])}).distance);
  }
  float result = least[0];
  for (std::size_t l = 1; l < k_width; ++l) result = least[l] < result ? least[l] : result;
  return result;
}

template <class Shape>
float least_distance(const ShapeNumbers& numbers, const float* min, const float* max) noexcept {
  return Shape::least_distance(numbers, min, max);
}

template <class Shape>
constexpr ColliderLanes lanes_of() {
  return {nearest<Shape>, least_distance<Shape>, mark<Shape>, resolve<Shape>, separate<Shape>};
}

}  // namespace
}  // namespace mallow::MALLOW_LEVEL

// Contact of model 2, section 4 A, and the distances that tell whom it may concern. Each lane is a particle.
#include "motion/contact_kernels.h"

#include "core/lanes.h"
#include "shapes/norm_range.h"

namespace mallow::MALLOW_LEVEL {
namespace {

void reach(ConstVectors velocity, const float* surface_velocity, float time_step, float offset,
           std::size_t begin, std::size_t end, float* reach) noexcept {
  for_rows(begin, end, [&](auto rows) {
    LaneVec3 w = get(rows, velocity);
    w.x -= surface_velocity[0];
    w.y -= surface_velocity[1];
    w.z -= surface_velocity[2];
    const Lanes distance = offset + time_step * square_root(squared(w));
    rows.row -= begin;
    rows.put(distance, reach);
  });
}

// What of x is beyond a range, on either side.
Lanes beyond(const Lanes& x, float low, float high) {
  return larger(larger(low - x, x - high), Lanes{});
}

// Squares are compared, so that there is no root; "not farther" holds for what is not a number, too.
LaneMask is_near(const Obstacle& o, const LaneVec3& x, const Lanes& reach) {
  const Lanes squared_reach = reach * reach;
  if (o.kind == Obstacle::plane) return ~((o.a[0] * x.x + (o.a[1] * x.y + o.a[2] * x.z)) - o.b[0] > reach);
  if (o.kind == Obstacle::sphere) {
    const Lanes distance = squared({x.x - o.a[0], x.y - o.a[1], x.z - o.a[2]});
    const Lanes limit = o.inside ? o.b[0] - reach : o.b[0] + reach;
    return o.inside ? ~((distance < limit * limit) & (limit > 0.0f)) : ~(distance > limit * limit);
  }
  const LaneVec3 outside = {beyond(x.x, o.a[0], o.b[0]), beyond(x.y, o.a[1], o.b[1]),
                            beyond(x.z, o.a[2], o.b[2])};
  return ~(squared(outside) > squared_reach);
}

void mark(const Obstacle& obstacle, ConstVectors position, float slack, std::size_t begin, std::size_t end,
          const float* reach, std::uint8_t* flags) noexcept {
  for_rows(begin, end, [&](auto rows) {
    const LaneVec3 x = get(rows, position);
    rows.row -= begin;
    unsigned near = rows.valid(bits(is_near(obstacle, x, rows.get(reach) + slack)));
    for (; near != 0; near &= near - 1) flags[rows.row + static_cast<unsigned>(__builtin_ctz(near))] |= 1;
  });
}

/// As SurfacePoint has them.
struct Surface {
  Lanes distance;
  LaneVec3 normal;
};

Lanes dot(const LaneVec3& a, const LaneVec3& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
LaneVec3 constant(const float* v) {
  return {all_lanes(v[0]), all_lanes(v[1]), all_lanes(v[2])};
}
LaneVec3 select(const LaneMask& mask, const LaneVec3& a, const LaneVec3& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}

LaneMask has_root(const Lanes& square) {
  return (square > k_least_square) & (square < k_greatest_square);
}

Surface sphere_surface(const Obstacle& sphere, const LaneVec3& x, LaneMask& left) {
  const LaneVec3 offset = {x.x - sphere.a[0], x.y - sphere.a[1], x.z - sphere.a[2]};
  const Lanes square = squared(offset), length = square_root(square);
  left |= ~has_root(square);
  return {length - sphere.b[0], {offset.x / length, offset.y / length, offset.z / length}};
}

Surface box_surface(const Obstacle& box, const LaneVec3& x, LaneMask& left) {
  const Lanes zero = {}, one = all_lanes(1.0f);
  const LaneVec3 below = {box.a[0] - x.x, box.a[1] - x.y, box.a[2] - x.z};
  const LaneVec3 above = {x.x - box.b[0], x.y - box.b[1], x.z - box.b[2]};
  // On or in the box the nearest face counts; z wins a tie.
  Surface face = {all_lanes(-__builtin_inff()), {zero, zero, one}};
  const auto take_farther = [&](const Lanes& distance, const LaneVec3& normal) {
    const LaneMask farther = distance > face.distance;
    face = {farther ? distance : face.distance, select(farther, normal, face.normal)};
  };
  take_farther(above.z, {zero, zero, one});
  take_farther(below.z, {-zero, -zero, -one});
  take_farther(above.y, {zero, one, zero});
  take_farther(below.y, {-zero, -one, -zero});
  take_farther(above.x, {one, zero, zero});
  take_farther(below.x, {-one, -zero, -zero});
  const LaneVec3 outside = {larger(above.x, zero) - larger(below.x, zero),
                            larger(above.y, zero) - larger(below.y, zero),
                            larger(above.z, zero) - larger(below.z, zero)};
  const Lanes square = squared(outside), length = square_root(square);
  const LaneMask is_inside = (outside.x == 0.0f) & (outside.y == 0.0f) & (outside.z == 0.0f);
  left |= ~(is_inside | has_root(square));
  return {is_inside ? face.distance : length,
          select(is_inside, face.normal, {outside.x / length, outside.y / length, outside.z / length})};
}

Surface nearest_surface(const Obstacle& obstacle, const LaneVec3& x, LaneMask& left) {
  if (obstacle.kind == Obstacle::plane) {
    const LaneVec3 normal = constant(obstacle.a);
    return {dot(normal, x) - obstacle.b[0], normal};
  }
  if (obstacle.kind == Obstacle::box) return box_surface(obstacle, x, left);
  const Surface s = sphere_surface(obstacle, x, left);
  if (!obstacle.inside) return s;
  return {-s.distance, {-s.normal.x, -s.normal.y, -s.normal.z}};
}

LaneVec3 at(const LaneVec3& x, const Lanes& t, const LaneVec3& way) {
  return {x.x + t * way.x, x.y + t * way.y, x.z + t * way.z};
}

/// As meet() of motion/contact.h.
Surface meet(const Obstacle& obstacle, float offset, const LaneVec3& x, const LaneVec3& way, LaneMask& left) {
  if (obstacle.kind == Obstacle::plane) return nearest_surface(obstacle, x, left);
  if (obstacle.inside) {
    const Surface end = nearest_surface(obstacle, {x.x + way.x, x.y + way.y, x.z + way.z}, left);
    return {end.distance - dot(way, end.normal), end.normal};
  }
  const Lanes length = square_root(squared(way));
  Lanes t = {};
  Surface met = nearest_surface(obstacle, x, left);
  LaneMask apart = {}, going = t == 0.0f;
  for (int look = 0; look < k_most_looks; ++look) {
    const Lanes gap = met.distance - offset;
    going &= gap > k_near_enough * length;
    if (!any(going)) break;
    t = going ? t + gap / length : t;
    const LaneMask passes = going & ~(t < 1.0f);
    apart |= passes;
    going &= ~passes;
    LaneMask odd = {};
    const Surface next = nearest_surface(obstacle, at(x, t, way), odd);
    left |= going & odd;
    met = {going ? next.distance : met.distance, select(going, next.normal, met.normal)};
  }
  return {apart ? all_lanes(__builtin_inff()) : met.distance - t * dot(way, met.normal), met.normal};
}

/// As bounce() of motion/contact.cpp.
Lanes bounce(float restitution, const Lanes& approach, const Lanes& gap, const LaneVec3& normal,
             const ContactStep& step) {
  const Lanes none = all_lanes(-__builtin_inff()), zero = {};
  const LaneMask bounces = approach < -step.least_bounce;
  if (!(restitution > 0) || !any(bounces)) return none;
  const Lanes gravity = larger(zero, dot(constant(step.gravity), normal) * -1.0f);
  const Lanes half_kick = 0.5f * gravity * step.time_step, speed = half_kick - approach;
  const float kept = restitution * restitution;
  const Lanes square = kept * (speed * speed) - 2.0f * (1.0f - kept) * gravity * larger(gap, zero);
  return (bounces & (square > 0.0f)) ? smaller(square_root(square) - half_kick, -approach) : none;
}

/// As the function of motion/contact.h.
LaneVec3 resolve_contact(const ContactSurface& surface, const Surface& met, const ContactStep& step,
                         const LaneVec3& before, const LaneVec3& v) {
  const LaneVec3 &n = met.normal, u = constant(surface.velocity);
  const Lanes gap = met.distance - step.contact_offset, zero = {};
  const LaneVec3 relative = {v.x - u.x, v.y - u.y, v.z - u.z};
  const Lanes normal_velocity = dot(relative, n);
  const LaneMask apart = gap + step.time_step * normal_velocity >= 0.0f;
  if (!any(~apart)) return v;

  const LaneVec3 relative_before = {before.x - u.x, before.y - u.y, before.z - u.z};
  const Lanes approach = dot(relative_before, n);
  const Lanes reach = -gap / step.time_step;
  const Lanes target = larger(gap >= 0.0f ? reach : smaller(reach, all_lanes(step.max_push)),
                              bounce(surface.restitution, approach, gap, n, step));
  const Lanes change = target - normal_velocity;

  const auto tangential_part = [&](const LaneVec3& w, const Lanes& w_n) {
    return LaneVec3{w.x - w_n * n.x, w.y - w_n * n.y, w.z - w_n * n.z};
  };
  const LaneVec3 tangential = tangential_part(relative, normal_velocity);
  const Lanes square = squared(tangential), speed = square_root(square), one = all_lanes(1.0f);
  Lanes taken = speed > 0.0f ? smaller(one, surface.friction * change / speed) : one;
  const Lanes along = dot(tangential, tangential_part(relative_before, approach));
  taken = along < 0.0f ? smaller(taken, larger(zero, 1.0f + along / square)) : taken;
  const Lanes kept = 1.0f - taken;
  return select(apart, v,
                {u.x + target * n.x + kept * tangential.x, u.y + target * n.y + kept * tangential.y,
                 u.z + target * n.z + kept * tangential.z});
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

std::size_t resolve(const Obstacle& obstacle, const ContactSurface& surface, const ContactStep& step,
                    ConstVectors position, ConstVectors before, std::uint32_t* rows, std::size_t count,
                    Vectors velocity, float& fastest) noexcept {
  const LaneVec3 u = constant(surface.velocity);
  std::size_t left_count = 0;
  for (std::size_t k = 0; k < count; k += k_width) {
    const ListedRows listed{rows + k, count - k < k_width ? count - k : k_width};
    const LaneVec3 free = get(listed, {velocity.x, velocity.y, velocity.z});
    const LaneVec3 way = {step.time_step * (free.x - u.x), step.time_step * (free.y - u.y),
                          step.time_step * (free.z - u.z)};
    LaneMask odd = {};
    const Surface met = meet(obstacle, step.contact_offset, get(listed, position), way, odd);
    const LaneVec3 v = select(odd, free, resolve_contact(surface, met, step, get(listed, before), free));
    listed.put(v.x, velocity.x);
    listed.put(v.y, velocity.y);
    listed.put(v.z, velocity.z);
    const Lanes squares = squared(v);
    for (std::size_t l = 0; l < listed.count; ++l) {
      fastest = fastest < squares[l] ? squares[l] : fastest;
      rows[left_count] = rows[k + l];
      left_count += odd[l] != 0;
    }
  }
  return left_count;
}

}  // namespace

extern const ContactKernels contact_kernels;
const ContactKernels contact_kernels = {reach, mark, resolve};

}  // namespace mallow::MALLOW_LEVEL

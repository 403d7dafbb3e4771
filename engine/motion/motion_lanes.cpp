// Blend and positions of model section 4 [TK eq. 10, 11, 13] and V of section 3 [TK eq. 12]. Each lane is a
// particle.
#include "motion/motion_lanes.h"

#include "core/double_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

float smallest(const Lanes& lanes) {
  float result = lanes[0];
  for (std::size_t l = 1; l < k_width; ++l) result = lanes[l] < result ? lanes[l] : result;
  return result;
}
float largest(const Lanes& lanes) {
  return -smallest(-lanes);
}

// a_ext without contact. Vectors of lanes go through memory where it is called.
template <class Rows>
MALLOW_INLINE LaneVec3 external_acceleration(const ForcesInput& in, const Rows& rows, LaneVec3 sum) {
  if (in.cross_group.x) sum += get(rows, in.cross_group);
  if (in.walls.x) sum += get(rows, in.walls);
  if (in.user.x) sum += get(rows, in.user);
  return sum;
}

/// What rows lie in, and how fast they are.
struct Bounds {
  LaneVec3 min = {all_lanes(k_infinity), all_lanes(k_infinity), all_lanes(k_infinity)}, max = -min;
  Lanes fastest = {};

  void add(const LaneVec3& x, const LaneVec3& v) {
    min = smaller(min, x);
    max = larger(max, x);
    fastest = larger(fastest, squared(v));
  }
  BlockBounds of_block() const {
    return {{smallest(min.x), smallest(min.y), smallest(min.z)},
            {largest(max.x), largest(max.y), largest(max.z)},
            largest(fastest)};
  }
};

LaneVec3 cross(const LaneVec3& a, const LaneVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

BlockBounds blend(const ForcesInput& in, std::size_t begin, std::size_t end, Vectors velocity) noexcept {
  Bounds bounds;
  for_rows(begin, end, [&](auto rows) {
    LaneVec3 v = get(rows, in.velocity);
    if (in.damping > 0) {
      const LaneVec3 arm = get(rows, in.position) - all_lanes(in.center);
      v += in.damping * (all_lanes(in.velocity_of_center) + cross(all_lanes(in.spin), arm) - v);
    }
    v += in.time_step * external_acceleration(in, rows, all_lanes(in.gravity));
    if (in.sph_acceleration.x) v += in.sph_factor * get(rows, in.sph_acceleration);
    if (in.pull.x) {
      auto group_rows = rows;
      group_rows.row -= in.group_begin;
      v += in.elastic_factor * get(group_rows, in.pull);
    }
    put(rows, v, velocity);
    bounds.add(get(rows, in.position), v);
  });
  return bounds.of_block();
}

BlockBounds bounds(const ForcesInput& in, std::size_t begin, std::size_t end,
                   ConstVectors velocity) noexcept {
  Bounds bounds;
  for_rows(begin, end, [&](auto rows) { bounds.add(get(rows, in.position), get(rows, velocity)); });
  return bounds.of_block();
}

bool advance(const ForcesInput& in, std::size_t begin, std::size_t end, ConstVectors velocity,
             Vectors position) noexcept {
  LaneMask bad = {};
  for_rows(begin, end, [&](auto rows) {
    const LaneVec3 v = get(rows, velocity);
    const LaneVec3 x = get(rows, in.position) + in.time_step * v;
    put(rows, x, position);
    // 0 of what is finite, else not a number.
    const Lanes none = (v.x - v.x) + (v.y - v.y) + (v.z - v.z) + (x.x - x.x) + (x.y - x.y) + (x.z - x.z);
    bad |= none != 0.0f;
  });
  return !any(bad);
}

void external(const ForcesInput& in, std::size_t begin, std::size_t end, ConstVectors free,
              ConstVectors velocity, float* external) noexcept {
  for_rows(begin, end, [&](auto rows) {
    LaneVec3 a = external_acceleration(in, rows, all_lanes(in.gravity));
    const LaneVec3 v = get(rows, velocity);
    rows.row -= begin;
    a += (v - get(rows, free)) / in.time_step;
    rows.put(square_root(squared(a)), external);
  });
}

float fastest(const ForcesInput& in, std::size_t begin, std::size_t end) noexcept {
  Lanes most = all_lanes(-1);
  LaneMask undefined = {};
  for_rows(begin, end, [&](auto rows) {
    LaneVec3 a = all_lanes(in.gravity);
    if (in.sph_acceleration.x) a = in.sph_factor * get(rows, in.sph_acceleration) + a;
    const LaneVec3 v = get(rows, in.velocity) + in.time_step * external_acceleration(in, rows, a);
    Lanes speed = squared(v);
    if (in.pin) {
      // Where a block ends, lanes that have no row repeat the first of theirs.
      const std::size_t count = static_cast<std::size_t>(count_bits(rows.valid(~0u >> (32 - k_width))));
      for (std::size_t l = 0; l < k_width; ++l)
        if (in.pin[rows.row + (l < count ? l : 0)] != 0) speed[l] = -1;
    }
    most = larger(most, speed);
    undefined |= speed != speed;
  });
  return any(undefined) ? k_not_a_number : largest(most);
}

void rigid_sums(ConstVectors position, ConstVectors velocity, const double* near, std::size_t begin,
                std::size_t end, double* sums) noexcept {
  sum_rows<16>(
      begin, end,
      [&](const auto& get, auto* s) {
        const auto x = get(position.x) - near[0], y = get(position.y) - near[1],
                   z = get(position.z) - near[2];
        const auto vx = get(velocity.x), vy = get(velocity.y), vz = get(velocity.z);
        s[0] += x, s[1] += y, s[2] += z;
        s[3] += vx, s[4] += vy, s[5] += vz;
        s[6] += y * vz - z * vy, s[7] += z * vx - x * vz, s[8] += x * vy - y * vx;
        s[9] += vx * vx + vy * vy + vz * vz;
        s[10] += x * x, s[11] += x * y, s[12] += x * z, s[13] += y * y, s[14] += y * z, s[15] += z * z;
      },
      sums);
}

}  // namespace

extern const MotionLanes motion_lanes;
const MotionLanes motion_lanes = {blend, bounds, advance, external, fastest, rigid_sums};

}  // namespace mallow::MALLOW_LEVEL

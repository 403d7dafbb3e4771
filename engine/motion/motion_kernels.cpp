// Blend and positions of model section 4 [TK eq. 10, 11, 13] and V of section 3 [TK eq. 12]. Each lane is a
// particle.
#include "motion/motion_kernels.h"

#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

void add(const LaneVec3& term, LaneVec3& sum) {
  sum.x += term.x;
  sum.y += term.y;
  sum.z += term.z;
}
void add(const Lanes& factor, const LaneVec3& term, LaneVec3& sum) {
  add({factor * term.x, factor * term.y, factor * term.z}, sum);
}
float smallest(const Lanes& lanes) {
  float result = lanes[0];
  for (std::size_t l = 1; l < k_width; ++l) result = lanes[l] < result ? lanes[l] : result;
  return result;
}
float largest(const Lanes& lanes) {
  return -smallest(-lanes);
}

// a_ext without contact.
template <class Rows>
LaneVec3 external_acceleration(const ForcesInput& in, const Rows& rows, LaneVec3 sum) {
  if (in.cross_group.x) add(get(rows, in.cross_group), sum);
  if (in.user.x) add(get(rows, in.user), sum);
  return sum;
}
LaneVec3 gravity(const ForcesInput& in) {
  return {all_lanes(in.gravity[0]), all_lanes(in.gravity[1]), all_lanes(in.gravity[2])};
}

/// What rows lie in, and how fast they are.
struct Bounds {
  static constexpr float k_infinity = __builtin_inff();
  LaneVec3 min = {all_lanes(k_infinity), all_lanes(k_infinity), all_lanes(k_infinity)};
  LaneVec3 max = {all_lanes(-k_infinity), all_lanes(-k_infinity), all_lanes(-k_infinity)};
  Lanes fastest = {};

  void add(const LaneVec3& x, const LaneVec3& v) {
    min = {smaller(min.x, x.x), smaller(min.y, x.y), smaller(min.z, x.z)};
    max = {larger(max.x, x.x), larger(max.y, x.y), larger(max.z, x.z)};
    fastest = larger(fastest, squared(v));
  }
  BlockBounds of_block() const {
    return {{smallest(min.x), smallest(min.y), smallest(min.z)},
            {largest(max.x), largest(max.y), largest(max.z)},
            largest(fastest)};
  }
};

BlockBounds blend(const ForcesInput& in, std::size_t begin, std::size_t end, Vectors velocity) noexcept {
  Bounds bounds;
  for_rows(begin, end, [&](auto rows) {
    LaneVec3 v = get(rows, in.velocity);
    add(all_lanes(in.time_step), external_acceleration(in, rows, gravity(in)), v);
    if (in.sph_acceleration.x) add(all_lanes(in.sph_factor), get(rows, in.sph_acceleration), v);
    if (in.pull.x) {
      auto group_rows = rows;
      group_rows.row -= in.group_begin;
      add(all_lanes(in.elastic_factor), get(group_rows, in.pull), v);
    }
    rows.put(v.x, velocity.x);
    rows.put(v.y, velocity.y);
    rows.put(v.z, velocity.z);
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
    LaneVec3 x = get(rows, in.position);
    add(all_lanes(in.time_step), v, x);
    rows.put(x.x, position.x);
    rows.put(x.y, position.y);
    rows.put(x.z, position.z);
    // 0 of what is finite, else not a number.
    const Lanes none = (v.x - v.x) + (v.y - v.y) + (v.z - v.z) + (x.x - x.x) + (x.y - x.y) + (x.z - x.z);
    bad |= none != 0.0f;
  });
  return !any(bad);
}

void external(const ForcesInput& in, std::size_t begin, std::size_t end, ConstVectors free,
              ConstVectors velocity, float* external) noexcept {
  for_rows(begin, end, [&](auto rows) {
    LaneVec3 a = external_acceleration(in, rows, gravity(in));
    const LaneVec3 v = get(rows, velocity);
    rows.row -= begin;
    const LaneVec3 before = get(rows, free);
    add({(v.x - before.x) / in.time_step, (v.y - before.y) / in.time_step, (v.z - before.z) / in.time_step},
        a);
    rows.put(square_root(squared(a)), external);
  });
}

float fastest(const ForcesInput& in, std::size_t begin, std::size_t end) noexcept {
  Lanes most = all_lanes(-1);
  LaneMask undefined = {};
  for_rows(begin, end, [&](auto rows) {
    const LaneVec3 sph = get(rows, in.sph_acceleration);
    LaneVec3 a = {in.sph_factor * sph.x, in.sph_factor * sph.y, in.sph_factor * sph.z};
    add(gravity(in), a);
    LaneVec3 v = get(rows, in.velocity);
    add(all_lanes(in.time_step), external_acceleration(in, rows, a), v);
    Lanes speed = squared(v);
    if (in.pin) {
      // Where a block ends, lanes that have no row repeat the first of theirs.
      const std::size_t count =
          static_cast<std::size_t>(__builtin_popcount(rows.valid(~0u >> (32 - k_width))));
      for (std::size_t l = 0; l < k_width; ++l)
        if (in.pin[rows.row + (l < count ? l : 0)] != 0) speed[l] = -1;
    }
    most = larger(most, speed);
    undefined |= speed != speed;
  });
  return any(undefined) ? __builtin_nanf("") : largest(most);
}

}  // namespace

extern const MotionKernels motion_kernels;
const MotionKernels motion_kernels = {blend, bounds, advance, external, fastest};

}  // namespace mallow::MALLOW_LEVEL

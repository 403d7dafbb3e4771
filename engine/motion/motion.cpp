#include "motion/motion.h"

#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

void translate(Plane& plane, const Vec3& offset) {
  plane.offset += plane.normal.dot(offset);
}
void translate(Sphere& sphere, const Vec3& offset) {
  sphere.center += offset;
}
void translate(Box& box, const Vec3& offset) {
  box.min += offset;
  box.max += offset;
}
void translate(Union& shapes, const Vec3& offset) {
  for (Primitive& part : shapes.parts) std::visit([&](auto& shape) { translate(shape, offset); }, part);
}

/// The particles [begin, end) of the store; only reads and writes their own rows.
MotionSums move_block(const MotionInput& in, std::size_t begin, std::size_t end, ParticleStore& store) {
  MotionSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 x = store.position.get(i);
    Vec3 v = store.velocity.get(i);
    if (!store.pin.empty() && store.pin[i] != 0) {
      v = in.pin_velocities[store.pin[i] - 1u];
    } else {
      Vec3 external = in.gravity;
      if (in.cross_group) external += in.cross_group->get(i);
      if (in.user) external += in.user->get(i);
      v += in.time_step * external;
      if (in.sph_acceleration) v += in.alpha * in.time_step * in.sph_acceleration->get(i);
      if (in.pull) v += in.elastic_factor * in.pull->get(i - in.begin);
      const Vec3 free = v;
      for (const Collider& collider : in.colliders) v = resolve_contact(collider, in.contact, x, v);
      ++sums.unpinned;
      if (in.measure_external)
        sums.external += static_cast<double>((external + (v - free) / in.time_step).norm());
    }
    const Vec3 moved = x + in.time_step * v;
    store.next_velocity.set(i, v);
    store.next_position.set(i, moved);
    if (!(v.allFinite() && moved.allFinite()) && sums.bad_row == SIZE_MAX) sums.bad_row = i;
  }
  return sums;
}

}  // namespace

MotionSums move_particles(const MotionInput& in, int threads, ParticleStore& store,
                          std::vector<MotionSums>& partial) {
  return parallel_reduce(
      threads, in.end - in.begin, partial, MotionSums{},
      [&](std::size_t begin, std::size_t end) {
        return move_block(in, in.begin + begin, in.begin + end, store);
      },
      [](MotionSums a, const MotionSums& b) {
        a.external += b.external;
        a.unpinned += b.unpinned;
        a.bad_row = std::min(a.bad_row, b.bad_row);
        return a;
      });
}

void move_colliders(double time_step, std::span<Collider> colliders) {
  for (Collider& collider : colliders) {
    const Vec3 offset = static_cast<float>(time_step) * collider.velocity;
    if (offset != Vec3(0, 0, 0)) std::visit([&](auto& shape) { translate(shape, offset); }, collider.shape);
  }
}

}  // namespace mallow

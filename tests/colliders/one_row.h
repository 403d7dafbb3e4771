#pragma once

#include "colliders/contact.h"

namespace mallow {

/// What contact with a collider makes of the velocity v of a particle at x that came with `before`.
inline Vec3 resolve_one_row(const Collider& collider, const ContactStep& step, const Vec3& x,
                            const Vec3& before, const Vec3& v, ColliderLoad* load = nullptr) {
  VectorColumn position(1), old_velocity(1), velocity(1);
  position.set(0, x);
  old_velocity.set(0, before);
  velocity.set(0, v);
  std::vector<PlacedCollider> placed;
  place_colliders({&collider, 1}, {0, 0, 0}, step.time_step, InstructionLevel::baseline, placed);
  const BlockBounds bounds{{x[0], x[1], x[2]}, {x[0], x[1], x[2]}, v.squaredNorm()};
  resolve_contacts({0, 1, position, old_velocity, nullptr, bounds}, placed, step, velocity,
                   {load, load ? 1u : 0u});
  return velocity.get(0);
}

}  // namespace mallow

#include "motion/contact.h"

#include <algorithm>

namespace mallow {

Vec3 resolve_contact(const Collider& collider, const SurfacePoint& surface, const ContactStep& step,
                     const Vec3& v) {
  const float gap = surface.distance - step.contact_offset;
  const Vec3 relative = v - collider.velocity;
  const float normal_velocity = relative.dot(surface.normal);
  if (gap + step.time_step * normal_velocity >= 0) return v;

  const float bounce = -collider.restitution * normal_velocity;
  const float reach = -gap / step.time_step;  // just touches at the end of the step
  const float target = std::max(gap >= 0 ? reach : std::min(reach, step.max_push), bounce);
  const float change = target - normal_velocity;
  const Vec3 tangential = relative - normal_velocity * surface.normal;
  const float speed = tangential.norm();
  const float kept = speed > 0 ? std::max(0.0f, 1.0f - collider.friction * change / speed) : 0.0f;
  return collider.velocity + target * surface.normal + kept * tangential;
}

Vec3 resolve_contact(const Collider& collider, const ContactStep& step, const Vec3& x, const Vec3& v) {
  const SurfacePoint surface =
      std::visit([&](const auto& shape) { return nearest(shape, x); }, collider.shape);
  return resolve_contact(collider, surface, step, v);
}

}  // namespace mallow

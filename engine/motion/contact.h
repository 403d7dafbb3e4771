#pragma once

#include <array>

#include "mallow/collider.h"
#include "motion/contact_kernels.h"

namespace mallow {

/// What all parts of a collider share in contact.
ContactSurface contact_surface(const Collider& collider);

/// Where a particle at x meets a primitive on its straight way of one step, relative to it: a plane, with the
/// distance of x from it. What the particle passes by is infinitely far. A box that keeps particles in is six
/// planes, see faces().
SurfacePoint meet(const Plane& plane, float contact_offset, const Vec3& x, const Vec3& way);
SurfacePoint meet(const Sphere& sphere, float contact_offset, const Vec3& x, const Vec3& way);
SurfacePoint meet(const Box& box, float contact_offset, const Vec3& x, const Vec3& way);

/// The planes that a box which keeps particles in consists of: in a corner it is met at two or three of them.
std::array<Plane, 6> faces(const Box& box);

/// The velocity after contact of a particle that comes with `before` (v^t), would move with v, and meets the
/// plane `met`. [model 2, section 4 A]
Vec3 resolve_contact(const ContactSurface& surface, const SurfacePoint& met, const ContactStep& step,
                     const Vec3& before, const Vec3& v);
/// The same of a particle at x and a collider, whose parts are met one after the other.
Vec3 resolve_contact(const Collider& collider, const ContactStep& step, const Vec3& x, const Vec3& before,
                     const Vec3& v);

}  // namespace mallow

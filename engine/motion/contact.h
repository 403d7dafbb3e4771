#pragma once

#include "mallow/collider.h"
#include "motion/contact_kernels.h"

namespace mallow {

/// The velocity after contact of a particle that would move with v and is nearest to `surface` of the
/// collider. [model 5]
Vec3 resolve_contact(const Collider& collider, const SurfacePoint& surface, const ContactStep& step,
                     const Vec3& v);
/// The same of a particle at x.
Vec3 resolve_contact(const Collider& collider, const ContactStep& step, const Vec3& x, const Vec3& v);

}  // namespace mallow

#pragma once

#include "mallow/collider.h"

namespace mallow {

/// How near and how fast a contact is resolved in one step.
struct ContactStep {
  float time_step;       ///< Δt [s]
  float max_push;        ///< σ/(10 Δt0): speed at which a deep overlap is pushed out at the most [m/s]
  float contact_offset;  ///< gap at which a particle touches [m]
};

/// The velocity after contact of a particle that would move with v and is nearest to `surface` of the
/// collider. [model 5]
Vec3 resolve_contact(const Collider& collider, const SurfacePoint& surface, const ContactStep& step,
                     const Vec3& v);
/// The same of a particle at x.
Vec3 resolve_contact(const Collider& collider, const ContactStep& step, const Vec3& x, const Vec3& v);

}  // namespace mallow

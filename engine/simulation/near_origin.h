#pragma once

#include "core/column.h"
#include "mallow/body.h"

namespace mallow {

/// The point that positions of a simulation are kept relative to, chosen by its first body [m]: 0 along axes
/// where the body is within a thousand of its spacings of 0, a whole number near its middle where it is
/// farther. Single precision has seven digits; the ones in front would say only where the scene is, and what
/// is left for the motion would jitter: a body at 1e5 by a hundredth of a metre in every step.
Vec3 choose_origin(const Body& body);

/// x − origin, rounded once.
Vec3 relative_to(const Vec3& origin, const Vec3& x);

}  // namespace mallow

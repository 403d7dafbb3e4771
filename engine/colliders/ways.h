#pragma once

#include "mallow/collider.h"

/// What is asked of how colliders go and turn, as far as their velocities and keyframes say it.
namespace mallow {

/// Whether it goes or turns, now or between keyframes.
MALLOW_EXPORT bool is_driven(const Collider& collider);
/// Of what goes or turns edgewise somewhere on its way, and is meant to cut [m]: the side across the way of
/// the box around it, in its own frame. Infinite where it does not, is not four times as long, or is hollow.
float blade_thickness(const Collider& collider);
/// Largest speed of a corner of that box; of what has none, as planes, of its frame. [m/s]
double greatest_corner_speed(const Collider& collider);

}  // namespace mallow

#pragma once

#include <vector>

#include "textbook/particle.h"

/// Sections 2 and 6 of the model, [TK] eq. 7 and 3.2, for one group.
namespace mallow::textbook {

/// Positions -> reference shape, regions and what stays the same while it lasts.
void take_reference(const Group& group, std::vector<Particle>& particles);
/// Reference shape, positions, last rotations -> centres and rotations of the regions, goal positions.
void match_shape(const Group& group, std::vector<Particle>& particles);

}  // namespace mallow::textbook

#pragma once

#include <vector>

#include "textbook/particle.h"

/// Sections 2 and 6 of the model, [TK] eq. 7 and 3.2, for one group; section 7 of its second chapter.
namespace mallow::textbook {

/// Positions -> reference shape, regions and what stays the same while it lasts.
void take_reference(const Group& group, std::vector<Particle>& particles);
/// The same where `mean`, of |a_ext|, exceeds the threshold of some particles only: those rest beside the
/// nearest that holds, as its region is turned, or beside one that rests beside such a one.
void rest_anew(const Group& group, double mean, std::vector<Particle>& particles);
/// Reference shape, positions, last rotations -> centres and rotations of the regions, goal positions
/// and pulls. Where they are `lead` [s] later, if they go on as they do. [model 2, section 4 B]
void match_shape(const Group& group, double lead, std::vector<Particle>& particles);

}  // namespace mallow::textbook

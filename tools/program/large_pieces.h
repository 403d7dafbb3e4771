#pragma once

#include <span>
#include <vector>

#include "mallow/files.h"

namespace mallow::program {

/// Of each particle whether the piece that it is part of holds at least a twentieth of its body's particles
/// in the frame: what is in no such piece is a drop or a crumb. Particles of a body are one piece where they
/// are next to each other, or nearly: within one and a half spacings for certain, at over five never.
/// spacings: h of each body [m], > 0; the body of a particle without one is one piece.
std::vector<bool> in_large_pieces(const ParticleFrame& frame, std::span<const float> spacings);

}  // namespace mallow::program

#pragma once

#include <span>

#include "simulation/state.h"

namespace mallow {

/// Throws ConfigError where a point that is about to become one of `body` is nearer than a tenth of the
/// spacing to another of its points, or to a particle that is there: two particles in one place stay there
/// for ever, as nothing pushes either any way. positions: relative to `origin` [m].
void refuse_overlaps(Simulation::State& state, const BodyState& body, std::span<const Vec3> positions,
                     float spacing, const Vec3& origin);

}  // namespace mallow

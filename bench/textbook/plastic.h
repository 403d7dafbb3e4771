#pragma once

#include <vector>

#include "textbook/particle.h"

/// Section 5 of the model's second chapter, for one group whose material has a plastic_yield.
namespace mallow::textbook {

/// Rotations and moments of the regions -> S and κ, after Δt [s].
void flow(const Group& group, double time_step, std::vector<Particle>& particles);
/// Whether its positions should become its reference shape: it has flowed far, is torn, or is pressed
/// together.
bool reframe_is_due(const Group& group, const std::vector<Particle>& particles);
/// Takes them, and leaves the elastic strain that regions have.
void reframe(const Group& group, std::vector<Particle>& particles);

}  // namespace mallow::textbook

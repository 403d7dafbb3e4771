#pragma once

#include <vector>

#include "textbook/particle.h"

/// Section 5 of the model's second chapter, for one group whose material has a plastic_yield.
namespace mallow::textbook {

/// Rotations and moments of the regions -> S and κ, after Δt [s].
void flow(const Group& group, double time_step, std::vector<Particle>& particles);
/// Whether its positions should become its reference shape at a check: it has flowed far, or is pressed
/// together.
bool reframe_is_due(const Group& group, const std::vector<Particle>& particles);
/// Whether they should as two that have flowed by more than least_flow have come too far apart.
bool is_torn(const Group& group, double least_flow, const std::vector<Particle>& particles);
/// Whether half of it has flowed so far that this waits for no check.
bool has_flowed_too_far(const Group& group, const std::vector<Particle>& particles);
/// Takes them, and leaves the elastic strain that regions have, but for what would add to its energy. Where
/// `waits`, not if a blow strains half of them; returns whether it did.
bool reframe(const Group& group, bool waits, std::vector<Particle>& particles);

}  // namespace mallow::textbook

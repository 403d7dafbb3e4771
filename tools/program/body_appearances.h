#pragma once

#include <span>
#include <string>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "program/run_report.h"

namespace mallow::program {

/// The appearance of each body by its slot: that of its material, with a colour of a palette where that names
/// none. materials: their names by slot, where bodies have come that the scene has not: parts that were torn
/// off look as their material does, what was thrown at the scene has a look of its own.
std::vector<Appearance> body_appearances(const Scene& scene, std::span<const std::string> materials = {});

/// What is known of each body by its slot: brought up to date where bodies have come since; of those that are
/// gone, what was known stays. Returns whether any has come.
bool follow_bodies(const Simulation& simulation, std::vector<BodyInfo>& by_slot);
/// The same of a run that goes on, of which the names and spacings of its last frame are known: all that is
/// known of those that are still there. Who came since is told of with the next frame.
void know_bodies(const Simulation& simulation, std::vector<BodyInfo>& by_slot);
/// How many particles each has now, of those that are gone none.
void count_particles(const Simulation& simulation, std::vector<BodyInfo>& by_slot);
std::vector<SlotBody> slot_bodies(std::span<const BodyInfo> bodies);
std::vector<std::string> material_names(std::span<const BodyInfo> bodies);
std::vector<std::string> material_names(std::span<const SlotBody> bodies);
/// h of each [m], and behind them of those that had the slots before.
std::vector<float> spacings_of(std::span<const SlotBody> bodies, std::span<const PastBody> past = {});

/// The same before and after bodies have come: those whose slot is another's from this frame on.
std::vector<PastBody> past_bodies(std::span<const SlotBody> before, std::span<const SlotBody> after,
                                  int frame);
/// Who had the slots in a frame, each by a number: below `slots` it is who has that slot now, above it
/// `slots` and the place in `past`.
std::vector<std::uint32_t> slot_numbers_at(int frame, std::size_t slots, std::span<const PastBody> past);
/// Who had the slots in a frame.
std::vector<SlotBody> slot_bodies_at(int frame, std::vector<SlotBody> now, std::span<const PastBody> past);

}  // namespace mallow::program

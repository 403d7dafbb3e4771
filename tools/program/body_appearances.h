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
/// How many particles each has now, of those that are gone none.
void count_particles(const Simulation& simulation, std::vector<BodyInfo>& by_slot);
std::vector<std::string> material_names(std::span<const BodyInfo> bodies);

/// The same before and after bodies have come: those that had a slot until this frame, and another material.
std::vector<PastBody> past_bodies(std::span<const std::string> before, std::span<const std::string> after,
                                  int frame);
/// Names of materials by slot as they were in a frame.
std::vector<std::string> materials_at(int frame, std::vector<std::string> now,
                                      std::span<const PastBody> past);

}  // namespace mallow::program

#pragma once

#include <cstddef>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow::program {

/// The appearance of each body: that of its material, with a colour of a palette where that names none.
/// bodies: how many there are by now, where some are not the scene's: what was thrown has a look of its own.
std::vector<Appearance> body_appearances(const Scene& scene, std::size_t bodies = 0);
/// How many slots the bodies of a simulation take: those that are gone count.
std::size_t body_slots(const Simulation& simulation);

}  // namespace mallow::program

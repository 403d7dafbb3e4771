#pragma once

#include <vector>

#include "mallow/scene.h"

namespace mallow::program {

/// The appearance of each body: that of its material, with a colour of a palette where that names none.
std::vector<Appearance> body_appearances(const Scene& scene);

}  // namespace mallow::program

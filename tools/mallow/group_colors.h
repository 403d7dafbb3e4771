#pragma once

#include <vector>

#include "mallow/scene.h"

namespace mallow::cli {

/// The colour of each group, linear RGB: that of its material or, where it names none, one of a palette.
std::vector<Vec3> group_colors(const Scene& scene);

}  // namespace mallow::cli

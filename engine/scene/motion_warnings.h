#pragma once

#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow {

/// Of how colliders and emitters go and turn in a run: turns that keyframes or frames do not show, and
/// colliders that come into the mouth of a nozzle. seconds: of the run; frame: of one of its frames, > 0 [s].
std::vector<std::string> motion_warnings(const Scene& scene, double seconds, double frame);

}  // namespace mallow

#pragma once

#include <string>
#include <vector>

#include "mallow/report.h"
#include "mallow/surface_config.h"

namespace mallow {

/// Where a surface leaves matter out: voxels that are too coarse for particles, smoothing that takes small
/// pieces away.
std::vector<std::string> surface_warnings(const SurfaceConfig& config, const SimulationInfo& info);

}  // namespace mallow

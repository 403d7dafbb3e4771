#pragma once

#include <span>

#include "mallow/files.h"
#include "mallow/mesh.h"
#include "mallow/surface_config.h"

namespace mallow::cli {

/// The surfaces of all groups of a frame as one mesh; material_ids hold the group. spacings: h of each group
/// [m].
Mesh frame_surface(const ParticleFrame& frame, std::span<const float> spacings, const SurfaceConfig& config,
                   int threads);

}  // namespace mallow::cli

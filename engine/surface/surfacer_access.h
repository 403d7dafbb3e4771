#pragma once

#include <span>

#include "core/threads.h"
#include "mallow/surface.h"
#include "surface/surface_field.h"

namespace mallow {

/// What makes grids of a surfacer's frame.
struct MALLOW_EXPORT SurfacerAccess {
  static std::span<const SurfaceField> fields(const Surfacer& surfacer);
  static const Threads& threads(const Surfacer& surfacer);
};

}  // namespace mallow

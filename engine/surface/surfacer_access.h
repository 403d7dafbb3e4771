#pragma once

#include <span>

#include "core/threads.h"
#include "mallow/surface.h"
#include "surface/surface_field.h"

namespace mallow {

/// What makes grids of a surfacer's frame, and what tests look at.
struct MALLOW_EXPORT SurfacerAccess {
  /// Surfaces with particles that the last frame kept from the one before.
  static std::size_t kept(const Surfacer& surfacer);
  static std::span<const SurfaceField> fields(const Surfacer& surfacer);
  static const Threads& threads(const Surfacer& surfacer);
};

}  // namespace mallow

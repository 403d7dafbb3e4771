#pragma once

#include <span>
#include <string>

#include "core/threads.h"
#include "level_set/surface_field.h"

namespace mallow {

/// Fields as the content of a VDB file: level sets "surface", or "surface_0" and on where there are several,
/// in metres.
std::string level_set_vdb(std::span<const SurfaceField> fields, const Threads& threads);

}  // namespace mallow

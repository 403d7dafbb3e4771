#pragma once

#include <filesystem>
#include <span>

#include "level_set/surface_field.h"

namespace mallow {

/// Writes each field as an OpenVDB level set: "surface", or "surface_0" and on where there are several.
/// Distances in metres. Throws IoError.
void write_level_set(const std::filesystem::path& file, std::span<const SurfaceField> fields, int threads);

}  // namespace mallow

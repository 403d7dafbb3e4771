#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mallow/appearance.h"
#include "mallow/mesh.h"

namespace mallow {

/// The material id of a triangle, where a format gives a triangle one: that of most of its corners, the
/// smallest of three that differ, as they may where surfaces are joined.
std::uint8_t triangle_material(const Mesh& mesh, std::size_t triangle);

/// Throws ConfigError unless colours are in [0, 1] and there is an appearance for each triangle's material.
void require_appearances(const Mesh& mesh, std::span<const Appearance> palette);

}  // namespace mallow

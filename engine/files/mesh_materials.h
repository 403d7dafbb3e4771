#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mallow/mesh.h"

namespace mallow {

/// The material id of a triangle, where a format gives a triangle one: that of its first corner.
std::uint8_t triangle_material(const Mesh& mesh, std::size_t triangle);

/// Throws ConfigError unless colors are linear RGB in [0, 1] and there is one for each triangle's material.
void require_colors(const Mesh& mesh, std::span<const Vec3> colors);

}  // namespace mallow

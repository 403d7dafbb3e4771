#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/vec3.h"

/// What EXT_meshopt_compression takes from the library meshoptimizer, which a build may lack.
namespace mallow {

/// Whether this build has the library; without it the functions below are not called.
bool has_meshopt();

/// Puts triangles and vertices into an order in which they compress well. corners: three for each triangle,
/// replaced by numbers in the new order. Gives the old numbers of the vertices in the new order; those that
/// no triangle has are left out.
std::vector<std::uint32_t> order_for_meshopt(std::vector<std::uint32_t>& corners, std::size_t vertices);

/// Normals for the filter OCTAHEDRAL, four bytes each.
std::string meshopt_octahedral(const std::vector<Vec3>& normals);
/// Mode ATTRIBUTES. stride: bytes of a vertex, a multiple of 4.
std::string meshopt_attributes(std::string_view vertices, std::size_t stride);
/// Mode TRIANGLES. vertices: above every corner.
std::string meshopt_triangles(const std::vector<std::uint32_t>& corners, std::size_t vertices);

}  // namespace mallow

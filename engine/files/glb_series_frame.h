#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mallow/mesh.h"

namespace mallow {

/// The triangles of one body in a packed frame.
struct PackedPart {
  std::uint32_t body = 0;
  std::size_t first_vertex = 0, vertices = 0;
  std::size_t first_corner = 0, corners = 0;
  std::array<int, 3> min{}, max{};  ///< of its places on the grid
};

/// A mesh as KHR_mesh_quantization has it: places are whole numbers on a grid, x = origin + scale · number.
struct PackedFrame {
  std::array<double, 3> origin{};  ///< [m]
  double scale = 1;                ///< [m], a power of two
  std::vector<PackedPart> parts;   ///< by ascending body
  std::size_t vertices = 0, corners = 0;
  std::size_t corner_bytes = 2;  ///< 2 or 4, for each corner, which counts within its part
  /// 8 bytes a vertex, 4 a vertex or none, corner_bytes a corner; or what meshoptimizer made of these.
  std::string position_bytes, normal_bytes, corner_numbers;
};

/// The grid has at most 2^14 places along each axis and is the same in consecutive frames of about one size,
/// so that what rests stays where it is. mesh: at least one triangle, valid, finite. compress: needs
/// has_meshopt(). Throws ConfigError where places are too far from 0 for such a grid.
PackedFrame pack_frame(const Mesh& mesh, bool compress);

}  // namespace mallow

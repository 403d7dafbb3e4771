#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mallow/export.h"
#include "mallow/mesh.h"

namespace mallow {

/// The triangles of a closed mesh, all facing outwards.
struct Orientation {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  /// Triangles cannot agree on which side is outside: inside is what lies behind an odd number of them.
  bool even_odd = false;
  double volume = 0;                    ///< [m³] enclosed, cavities less; what overlaps counts twice
  std::vector<std::string> notes = {};  ///< what was turned, and what was taken for a cavity
};

/// Finds which way the triangles of a closed, welded mesh face. Neighbours are made to agree, as most of them
/// do. A shell is what edges connect: one that is inside out is turned, together with all shells within it,
/// unless it lies within another one: then it bounds a cavity.
MALLOW_EXPORT Orientation orient(const Mesh& mesh);

}  // namespace mallow

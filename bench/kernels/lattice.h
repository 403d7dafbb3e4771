#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "core/column.h"

namespace mallow::bench {

/// Points of a cubic lattice, as the kernels' scenes are made of.
struct LatticeScene {
  std::string name;
  std::array<int, 3> count;
  float spacing;  ///< h [m]
  float radius;   ///< σ [m]
};

/// The bodies of Table 1 that are lattices: 23.6, 80.7 and 755.3 neighbours on average.
inline const LatticeScene k_cube_15{"cube_15", {15, 15, 15}, 22.0f / 15, 2.9f};
inline const LatticeScene k_cube_22{"cube_22", {22, 22, 22}, 1.0f, 2.9f};
inline const LatticeScene k_bar{"bar_sigma8", {10, 10, 36}, 40.0f / 36, 8.0f};

/// The points in cell order of `radius`, as the engine keeps its rows. jitter: random displacement in
/// spacings.
VectorColumn lattice_points(const LatticeScene& scene, float jitter = 0);
/// Row k becomes what row order[k] was.
VectorColumn reordered(const VectorColumn& points, std::span<const std::uint32_t> order);
/// The points twisted and bent by up to some tenths of a radian, so that no kernel meets the trivial case.
VectorColumn bent(const VectorColumn& points);

}  // namespace mallow::bench

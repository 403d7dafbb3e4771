#pragma once

#include <array>
#include <cstdint>

namespace mallow {

/// Corner c of a cell lies at (c >> 2 & 1, c >> 1 & 1, c & 1). Edge 4 a + k runs along axis a; k = 2 u + v
/// places it in the two axes behind a, cyclically.
inline constexpr int k_cell_edges = 12;
inline constexpr std::uint16_t k_all_edges = (1 << k_cell_edges) - 1;

/// The two corners of an edge, the lower one first.
struct EdgeCorners {
  int low, high;
};
constexpr EdgeCorners edge_corners(int edge) {
  const int axis = edge / 4, u = edge >> 1 & 1, v = edge & 1;
  const int low = u << (2 - (axis + 1) % 3) | v << (2 - (axis + 2) % 3);
  return {low, low | 1 << (2 - axis)};
}

/// The patches of surface in a cell: each cut edge belongs to one.
struct CellPatches {
  std::int8_t count = 0;
  std::array<std::uint16_t, 4> edges{};  ///< of each patch, a bit each
  /// Face (2 axis + side) that one patch crosses twice, or −1. Two such cells with that face in common would
  /// share an edge of the mesh twice; there both take the patches 256 on instead.
  std::int8_t twice = -1;
};

/// By the corners inside, a bit each. On a face whose diagonals differ the inside corners are kept apart; in
/// the second half, 256 on, those on face `twice` are joined.
extern const std::array<CellPatches, 512> k_cell_patches;
/// Which patch of each of these an edge belongs to, where it is cut; else 0.
struct PatchOfEdge {
  std::uint8_t at[512][k_cell_edges];
};
extern const PatchOfEdge k_patch_of_edge;

}  // namespace mallow

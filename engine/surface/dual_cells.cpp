#include "surface/dual_cells.h"

namespace mallow {
namespace {

/// Corners of a face, around it.
constexpr std::array<int, 4> face_corners(int face) {
  const int axis = face / 2, side = face % 2;
  const int u = 1 << (2 - (axis + 1) % 3), v = 1 << (2 - (axis + 2) % 3), base = side << (2 - axis);
  return {base, base | u, base | u | v, base | v};
}

constexpr int edge_between(int a, int b) {
  for (int e = 0; e < k_cell_edges; ++e) {
    const EdgeCorners corners = edge_corners(e);
    if ((corners.low == a && corners.high == b) || (corners.low == b && corners.high == a)) return e;
  }
  return -1;
}

/// Patches of a cell: cut edges that lines on its faces connect. On `joined` (a face, or −1) the two inside
/// corners of a diagonal are joined.
constexpr CellPatches find_patches(unsigned inside, int joined) {
  std::array<int, k_cell_edges> patch{};
  for (int e = 0; e < k_cell_edges; ++e) {
    const EdgeCorners c = edge_corners(e);
    patch[static_cast<std::size_t>(e)] = (inside >> c.low & 1) != (inside >> c.high & 1) ? e : -1;
  }
  const auto join = [&](int a, int b) {
    const int to = patch[static_cast<std::size_t>(a)], from = patch[static_cast<std::size_t>(b)];
    for (int& p : patch)
      if (p == from) p = to;
  };
  std::array<std::array<int, 4>, 6> lines{};  // per face: edges of the one line, of the other; −1
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> corners = face_corners(face);
    std::array<int, 4> cut{};
    std::size_t cuts = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int e = edge_between(corners[k], corners[(k + 1) % 4]);
      if (patch[static_cast<std::size_t>(e)] >= 0) cut[cuts++] = e;
    }
    // Edge k runs from corner k to k + 1: corner 1 lies between edges 0 and 1.
    const bool shift = cuts == 4 && (((inside >> corners[1] & 1) != 0) == (face == joined));
    std::array<int, 4>& line = lines[static_cast<std::size_t>(face)];
    line.fill(-1);
    for (std::size_t k = 0; k < cuts; ++k) line[k] = cut[(k + (shift ? 1 : 0)) % cuts];
    for (std::size_t k = 0; k + 1 < cuts; k += 2) join(line[k], line[k + 1]);
  }
  CellPatches patches;
  std::array<std::int8_t, k_cell_edges> number{};
  number.fill(-1);
  for (std::size_t e = 0; e < k_cell_edges; ++e) {
    if (patch[e] < 0) continue;
    std::int8_t& n = number[static_cast<std::size_t>(patch[e])];
    if (n < 0) n = patches.count++;
    patches.edges[static_cast<std::size_t>(n)] |= static_cast<std::uint16_t>(1u << e);
  }
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4>& line = lines[static_cast<std::size_t>(face)];
    if (line[3] >= 0 && patch[static_cast<std::size_t>(line[0])] == patch[static_cast<std::size_t>(line[2])])
      patches.twice = static_cast<std::int8_t>(face);
  }
  return patches;
}

constexpr std::array<CellPatches, 512> find_all_patches() {
  std::array<CellPatches, 512> all{};
  for (unsigned inside = 0; inside < 256; ++inside) {
    all[inside] = find_patches(inside, -1);
    all[256 + inside] = find_patches(inside, all[inside].twice);
  }
  return all;
}

constexpr PatchOfEdge find_patch_of_edge() {
  const std::array<CellPatches, 512> all = find_all_patches();
  PatchOfEdge patch{};
  for (std::size_t cell = 0; cell < all.size(); ++cell)
    for (std::uint8_t p = 0; p < all[cell].count; ++p)
      for (std::size_t e = 0; e < k_cell_edges; ++e)
        if ((all[cell].edges[p] >> e & 1) != 0) patch.at[cell][e] = p;
  return patch;
}

}  // namespace

const std::array<CellPatches, 512> k_cell_patches = find_all_patches();
const PatchOfEdge k_patch_of_edge = find_patch_of_edge();

}  // namespace mallow

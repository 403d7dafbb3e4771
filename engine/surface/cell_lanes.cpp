// Which cells and edges the zero of a level set cuts, by bits (dual marching cubes, see cut_cells.h).
#include "surface/cell_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

static_assert(k_cluster == k_block_side, "a row of voxels is a row of lanes");
constexpr int k_side = k_block_side, k_slices = k_block_side + 1;

void find_signs(const float* distances, BlockBits& inside) noexcept {
  for (int x = 0; x < k_side; ++x) {
    std::uint64_t word = 0;
    for (int y = 0; y < k_side; ++y)
      word |= std::uint64_t{bits(is_larger(Floats{}, load(distances + (x * k_side + y) * k_side)))}
              << (k_side * y);
    inside.at[x] = word;
  }
}

/// Bits of the next voxels along z; `above` holds those of the block above.
MALLOW_INLINE std::uint64_t next_z(std::uint64_t here, std::uint64_t above) {
  return (here >> 1 & 0x7f7f7f7f7f7f7f7f) | (above << 7 & 0x8080808080808080);
}
/// Bits of the next voxels along y.
MALLOW_INLINE std::uint64_t next_y(std::uint64_t here, std::uint64_t above) {
  return here >> 8 | above << 56;
}

void find_corners(const BlockBits* const* inside, CornerBits& corners) {
  // By the offset along y and z.
  std::uint64_t slices[4][k_slices];
  for (int k = 0; k < 4; ++k) {
    for (int x = 0; x < k_side; ++x) slices[k][x] = inside[k]->at[x];
    slices[k][k_side] = inside[4 + k]->at[0];
  }
  for (int x = 0; x < k_slices; ++x) {
    const std::uint64_t here = slices[0][x], z = next_z(here, slices[1][x]);
    corners.at[0][x] = here;
    corners.at[1][x] = z;
    corners.at[2][x] = next_y(here, slices[2][x]);
    corners.at[3][x] = next_y(z, next_z(slices[2][x], slices[3][x]));
  }
}

/// Where corner c differs from a and b, and d does not: faces whose diagonals differ.
MALLOW_INLINE std::uint64_t crossed(std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
  return (a ^ b) & (a ^ c) & ~(a ^ d);
}

/// A cell with more than one patch has a face whose diagonals differ, or two corners at the ends of a long
/// diagonal apart from the other six: each corner is then on the side of the one across the cell.
void find_unclear(const CornerBits& corners, const BlockBits& cut, BlockBits& unclear) {
  std::uint64_t across[k_slices];  // faces between y and z
  const auto& at = corners.at;
  for (int x = 0; x < k_slices; ++x) across[x] = crossed(at[0][x], at[1][x], at[2][x], at[3][x]);
  for (int x = 0; x < k_side; ++x) {
    const std::uint64_t a = at[0][x], b = at[1][x], c = at[2][x], d = at[3][x], e = at[0][x + 1],
                        f = at[1][x + 1], g = at[2][x + 1], h = at[3][x + 1];
    const std::uint64_t faces = across[x] | across[x + 1] | crossed(a, b, e, f) | crossed(c, d, g, h) |
                                crossed(a, c, e, g) | crossed(b, d, f, h);
    const std::uint64_t diagonals = ~((a ^ h) | (b ^ g) | (c ^ f) | (d ^ e));
    unclear.at[x] = (faces | diagonals) & cut.at[x];
  }
}

/// all: the bits of all x together, some of which are set.
BitRange find_range(const BlockBits& bits, std::uint64_t all) {
  BitRange range{k_side, 0, first_bit(all) / k_side, last_bit(all) / k_side};
  for (int x = 0; x < k_side; ++x) {
    if (bits.at[x] == 0) continue;
    if (range.first_x == k_side) range.first_x = x;
    range.last_x = x;
  }
  return range;
}

MALLOW_INLINE std::uint32_t count(const BlockBits& bits) {
  std::uint32_t n = 0;
  for (const std::uint64_t word : bits.at) n += static_cast<std::uint32_t>(count_bits(word));
  return n;
}

void find_cells(const BlockBits* const* inside, CornerBits& corners, CellBits& cells) noexcept {
  find_corners(inside, corners);
  const auto& at = corners.at;
  std::uint64_t any[k_slices], all[k_slices], some = 0;
  for (int x = 0; x < k_slices; ++x) {
    any[x] = at[0][x] | at[1][x] | at[2][x] | at[3][x];
    all[x] = at[0][x] & at[1][x] & at[2][x] & at[3][x];
  }
  for (int x = 0; x < k_side; ++x) {
    cells.cut.at[x] = (any[x] | any[x + 1]) & ~(all[x] & all[x + 1]);
    some |= cells.cut.at[x];
  }
  cells.cells = cells.quads = 0;
  if (some == 0) return;
  for (int x = 0; x < k_side; ++x) {
    cells.edges[0].at[x] = at[0][x] ^ at[0][x + 1];
    cells.edges[1].at[x] = at[0][x] ^ at[2][x];
    cells.edges[2].at[x] = at[0][x] ^ at[1][x];
  }
  find_unclear(corners, cells.cut, cells.unclear);
  cells.range = find_range(cells.cut, some);
  cells.cells = count(cells.cut);
  cells.quads = count(cells.edges[0]) + count(cells.edges[1]) + count(cells.edges[2]);
}

std::size_t list_cells(const BlockBits& cut, std::uint16_t* list, std::uint16_t* place) noexcept {
  std::size_t n = 0;
  for (int x = 0; x < k_side; ++x) {
    for (std::uint64_t left = cut.at[x]; left != 0; left &= left - 1) {
      const auto cell = static_cast<std::uint16_t>(64 * x + first_bit(left));
      list[n] = cell;
      place[cell] = static_cast<std::uint16_t>(n++);
    }
  }
  return n;
}

}  // namespace

extern const CellLanes cell_lanes;
const CellLanes cell_lanes = {find_signs, find_cells, list_cells};

}  // namespace mallow::MALLOW_LEVEL

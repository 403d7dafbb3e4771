// Quads of dual marching cubes (Nielson 2004; see cut_cells.h), one by one, by the bits of the edges that are
// cut.
#include "surface/quad_lanes.h"

#include "core/cluster_lanes.h"
#include "surface/dual_cells.h"

namespace mallow::MALLOW_LEVEL {
namespace {

constexpr int k_side = k_block_side;

/// What is known of the cells around a block's edges, at −1 to 7 along each axis. Cells lie where the bits of
/// BlockBits do; those one below along z have a table of their own.
template <class Value>
struct CellTable {
  static constexpr int k_row = k_side, k_plane = (k_side + 1) * k_row, k_first = k_plane + k_row,
                       k_size = (k_side + 1) * k_plane;
  Value at[2][k_size + 1];  ///< [whether one below]; a row is written with one value behind it
};
/// Their first vertices.
using VertexTable = CellTable<std::uint32_t>;
/// Which of k_cell_patches they have, where they have more than one patch; else number 0, of whose patches
/// all edges are of the first.
using PatchTable = CellTable<std::uint16_t>;

MALLOW_INLINE void fill_row(const QuadBlock::Cells* blocks, int row, int to, VertexTable& table) {
  if (blocks[1].vertex != nullptr) {
    const Ints vertices = load(blocks[1].vertex + row) + static_cast<int>(blocks[1].first_vertex);
    store(vertices, table.at[0] + to);
    store(vertices, table.at[1] + to + 1);
  }
  if (blocks[0].vertex != nullptr)
    table.at[1][to] = blocks[0].first_vertex + blocks[0].vertex[row + k_side - 1];
}

void fill(const QuadBlock& block, VertexTable& table) {
  const BitRange range = block.range;
  for (int x = range.first_x - 1; x <= range.last_x; ++x) {
    const QuadBlock::Cells* const blocks = block.around + (x < 0 ? 0 : 4);
    const int plane = (x & (k_side - 1)) * k_side * k_side;
    const int to = VertexTable::k_first + x * VertexTable::k_plane;
    if (range.first_y == 0) fill_row(blocks, plane + (k_side - 1) * k_side, to - VertexTable::k_row, table);
    for (int y = range.first_y == 0 ? 0 : range.first_y - 1; y <= range.last_y; ++y)
      fill_row(blocks + 2, plane + y * k_side, to + y * VertexTable::k_row, table);
  }
}

/// Returns whether there is any cell with more than one patch.
bool fill(const QuadBlock& block, PatchTable& table) {
  std::size_t count = 0;
  for (const QuadBlock::Cells& cells : block.around) count += cells.patched_count;
  if (count == 0) return false;
  clear_bytes(&table, sizeof table);
  for (int k = 0; k < 8; ++k) {
    const QuadBlock::Cells& cells = block.around[k];
    for (std::size_t i = 0; i < cells.patched_count; ++i) {
      const int cell = cells.patched[i].cell;
      const int x = (cell >> 6) - (k & 4 ? 0 : k_side), y = (cell >> 3 & 7) - (k & 2 ? 0 : k_side),
                z = (cell & 7) - (k & 1 ? 0 : k_side);
      if (x < -1 || y < -1 || z < -1) continue;
      const int row = PatchTable::k_first + x * PatchTable::k_plane + y * PatchTable::k_row;
      if (z >= 0) table.at[0][row + z] = cells.patched[i].patches;
      if (z + 1 < k_side) table.at[1][row + z + 1] = cells.patched[i].patches;
    }
  }
  return true;
}

/// By a bit each axis: a block below along these.
constexpr float k_shift[8][4] = {{0, 0, 0},  {-8, 0, 0},  {0, -8, 0},  {-8, -8, 0},
                                 {0, 0, -8}, {-8, 0, -8}, {0, -8, -8}, {-8, -8, -8}};

/// What quads are written from.
struct QuadTables {
  const float* local;
  const std::uint8_t* patch_of_edge;
  VertexTable vertices;
  PatchTable patches;
};

/// A kind of edges whose quads are written alike.
struct EdgeKind {
  int axis;
  bool outwards;  ///< whether they lead outside
  bool border;    ///< whether cells around them are in blocks below
  bool patched;   ///< whether cells may have more than one patch
};

/// The edges of a block from voxels of one x, and where their triangles go.
struct EdgeSlice {
  std::uint64_t edges[3];
  int x;
  std::ptrdiff_t first;  ///< the first voxel in the tables
  QuadInts first_in_mesh;
  std::uint32_t* to;
};

/// The vertices of the quad about an edge, turned so that its shorter diagonal is from the first to the
/// third. Ties, as on flat faces, are not left to rounding. bit: of the edge in its slice.
template <EdgeKind kind>
MALLOW_INLINE QuadInts quad_of(const QuadTables& tables, const EdgeSlice& slice, int bit) {
  constexpr int k_u = (kind.axis + 1) % 3, k_v = (kind.axis + 2) % 3;
  // The cells around it, counter-clockwise seen from where it leads; where that is inside, the other way
  // round.
  constexpr int k_around[2][4][2] = {{{1, 1}, {1, 0}, {0, 0}, {0, 1}}, {{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
  [[maybe_unused]] const unsigned walls =
      (slice.x == 0 ? 1u : 0u) | (bit < k_side ? 2u : 0u) | (bit % k_side == 0 ? 4u : 0u);
  const std::ptrdiff_t first = slice.first + bit;
  std::uint32_t vertex[4];
  Quad place[4];
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
    const int u = k_around[kind.outwards][k][0], v = k_around[kind.outwards][k][1];
    const int below = u << k_u | v << k_v;  // bit a: one below along axis a
    const std::ptrdiff_t cell =
        first - (below & 1) * VertexTable::k_plane - (below >> 1 & 1) * VertexTable::k_row;
    vertex[k] = tables.vertices.at[below >> 2][cell];
    if constexpr (kind.patched) {
      const int edge = 4 * kind.axis + 2 * u + v;
      vertex[k] += tables.patch_of_edge[tables.patches.at[below >> 2][cell] * k_cell_edges + edge];
    }
    place[k] = load_quad(tables.local + 3 * std::size_t{vertex[k]});
    if constexpr (kind.border) place[k] += load_quad(k_shift[walls & static_cast<unsigned>(below)]);
  }
  const QuadInts quad = QuadInts{static_cast<int>(vertex[0]), static_cast<int>(vertex[1]),
                                 static_cast<int>(vertex[2]), static_cast<int>(vertex[3])} +
                        slice.first_in_mesh;
  const Quad a = place[1] - place[3], b = place[0] - place[2];
  const Quad xy = shuffled<0, 4, 1, 5>(a, b), z = shuffled<2, 6, 3, 7>(a, b);
  const Quad squares = xy * xy, z_squares = z * z;
  const Quad lengths = squares + (shuffled<2, 3, 2, 3>(squares) + z_squares);
  const QuadInts other = shuffled<0, 0, 0, 0>(lengths) < 0.99f * shuffled<1, 1, 1, 1>(lengths);
  const QuadInts turned = shuffled<1, 2, 3, 0>(quad);
  return other ? turned : quad;
}

/// Writes the quads of some edges of a kind, each behind those of all cells before and of axes before.
template <EdgeKind kind>
MALLOW_INLINE void write_kind(const QuadTables& tables, const EdgeSlice& slice, std::uint64_t some) {
  for (; some != 0; some &= some - 1) {
    const std::uint64_t through = some ^ (some - 1), below = through >> 1;
    const int before = count_bits(slice.edges[0] & (kind.axis > 0 ? through : below)) +
                       count_bits(slice.edges[1] & (kind.axis > 1 ? through : below)) +
                       count_bits(slice.edges[2] & below);
    const QuadInts quad = quad_of<kind>(tables, slice, first_bit(some));
    const QuadInts one = shuffled<0, 1, 2, 0>(quad), two = shuffled<2, 3, 2, 3>(quad);
    std::uint32_t* const to = slice.to + 6 * static_cast<std::ptrdiff_t>(before);
    copy_bytes(to, &one, sizeof one);
    copy_bytes(to + 4, &two, sizeof two / 2);
  }
}

template <int axis, bool patched>
MALLOW_INLINE void write_axis(const QuadTables& tables, const EdgeSlice& slice, std::uint64_t inside) {
  // Voxels whose cells below along an axis are in the block.
  constexpr std::uint64_t k_above[3] = {0, ~std::uint64_t{255}, 0xfefefefefefefefe};
  const std::uint64_t edges = slice.edges[axis];
  std::uint64_t inner = edges;
  for (int a = 0; a < 3; ++a)
    if (a != axis && (a > 0 || slice.x == 0)) inner &= k_above[a];
  write_kind<EdgeKind{axis, true, false, patched}>(tables, slice, inner & inside);
  write_kind<EdgeKind{axis, false, false, patched}>(tables, slice, inner & ~inside);
  if (inner == edges) return;
  write_kind<EdgeKind{axis, true, true, patched}>(tables, slice, edges & ~inner & inside);
  write_kind<EdgeKind{axis, false, true, patched}>(tables, slice, edges & ~inner & ~inside);
}

template <bool patched>
void write(const QuadBlock& block, const QuadTables& tables, std::uint32_t* to) {
  for (int x = 0; x < k_side; ++x) {
    const EdgeSlice slice = {{block.edges[0].at[x], block.edges[1].at[x], block.edges[2].at[x]},
                             x,
                             VertexTable::k_first + x * VertexTable::k_plane,
                             QuadInts{} + static_cast<int>(block.first_in_mesh),
                             to};
    if ((slice.edges[0] | slice.edges[1] | slice.edges[2]) == 0) continue;
    write_axis<0, patched>(tables, slice, block.inside->at[x]);
    write_axis<1, patched>(tables, slice, block.inside->at[x]);
    write_axis<2, patched>(tables, slice, block.inside->at[x]);
    for (const std::uint64_t edges : slice.edges) to += 6 * count_bits(edges);
  }
}

void write_quads(const QuadBlock& block, std::uint32_t* triangles) noexcept {
  QuadTables tables;
  tables.local = block.local;
  tables.patch_of_edge = block.patch_of_edge;
  fill(block, tables.vertices);
  if (fill(block, tables.patches))
    write<true>(block, tables, triangles);
  else
    write<false>(block, tables, triangles);
}

}  // namespace

extern const QuadLanes quad_lanes;
const QuadLanes quad_lanes = {write_quads};

}  // namespace mallow::MALLOW_LEVEL

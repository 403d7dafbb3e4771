// Vertices and quads of dual marching cubes (Nielson 2004; see cut_cells.h): eight vertices at a time, a lane
// each; quads one by one, as they follow each other in memory.
#include "surface/mesh_lanes.h"

#include "core/cluster_lanes.h"
#include "surface/dual_cells.h"

namespace mallow::MALLOW_LEVEL {
namespace {

constexpr int k_side = k_block_side;

/// A block's distances with one more below and two above along each axis, where cells need them. A row of
/// voxels lies at 4 to 11; what is behind it is read and dropped.
struct Padded {
  static constexpr int k_row = 16, k_plane = (k_side + 3) * k_row, k_first = k_plane + k_row + 4;
  float at[(k_side + 3) * k_plane];
};

/// The x and y of bits that are set, the first and the last.
struct SetRanges {
  struct Range {
    int first, last;
  } x, y;
};
/// slices: a word each x, some bit of which is set.
SetRanges find_ranges(const std::uint64_t* slices) {
  std::uint64_t all = 0;
  SetRanges set{{k_side, 0}, {}};
  for (int x = 0; x < k_side; ++x) {
    all |= slices[x];
    if (slices[x] == 0) continue;
    if (set.x.first == k_side) set.x.first = x;
    set.x.last = x;
  }
  set.y = {__builtin_ctzll(all) / k_side, (63 - __builtin_clzll(all)) / k_side};
  return set;
}

void pad_rows(const float* const* blocks, int from, int x, int y, int end_y, Padded& padded) {
  const float *const below = blocks[0], *const here = blocks[1], *const above = blocks[2];
  float* to = padded.at + Padded::k_first + x * Padded::k_plane + y * Padded::k_row;
  for (; y < end_y; ++y, from += k_side, to += Padded::k_row) {
    to[-1] = below[from + k_side - 1];
    store(load(here + from), to);
    __builtin_memcpy(to + k_side, above + from, 2 * sizeof(float));
  }
}

/// Copies what the cells that are cut need.
void pad(const VertexBlock& block, Padded& padded) {
  const SetRanges set = find_ranges(block.cut->at);
  const int end_y = set.y.last + 3;
  for (int x = set.x.first - 1; x <= set.x.last + 2; ++x) {
    const int plane = (x & (k_side - 1)) * k_side * k_side;
    const float* const* const blocks = block.distances + 9 * (x < 0 ? 0 : x < k_side ? 1 : 2);
    if (set.y.first == 0) pad_rows(blocks, plane + (k_side - 1) * k_side, x, -1, 0, padded);
    const int first = set.y.first == 0 ? 0 : set.y.first - 1;
    pad_rows(blocks + 3, plane + first * k_side, x, first, end_y < k_side ? end_y : k_side, padded);
    pad_rows(blocks + 6, plane, x, k_side, end_y, padded);
  }
}

/// Eight cells, a lane each: the voxels of a Padded, and the cells' lowest corners in it.
struct EightCells {
  const float* voxels;
  std::uint32_t at[k_cluster];
};
/// Distances at corners of cells, and below and above them along z: [x][y][z + 1].
struct Corners {
  Floats at[2][2][4];
  const Floats& corner(int c) const { return at[c >> 2][c >> 1 & 1][1 + (c & 1)]; }
};

/// Four voxels from (x, y, z) on along z.
MALLOW_INLINE void load_row(const EightCells& cells, int x, int y, int z, Floats* row) {
  load_named(cells.voxels + x * Padded::k_plane + y * Padded::k_row + z, 1, cells.at, row);
}

MALLOW_INLINE Ints any_lane(std::uint32_t value) {
  return Ints{} + static_cast<int>(value);
}

/// The mean of where the surface cuts the edges of patches, from the cells' lowest corners on. Never at a
/// corner, as cells that share it would put their vertices in one place. edges: a bit each of those of the
/// patch; the others of its cell count for nothing.
template <bool patched>
MALLOW_INLINE ClusterVec3 middle_of_cuts(const Corners& v, [[maybe_unused]] const Ints& edges) {
  Ints inside[8];
#pragma GCC unroll 8
  for (int c = 0; c < 8; ++c) inside[c] = is_larger(Floats{}, v.corner(c));
  Floats sum[3] = {};
  Ints count = {};
#pragma GCC unroll 12
  for (int e = 0; e < k_cell_edges; ++e) {
    const int axis = e / 4, u = e >> 1 & 1, w = e & 1, u_axis = (axis + 1) % 3, w_axis = (axis + 2) % 3;
    const int low_corner = u << (2 - u_axis) | w << (2 - w_axis), high_corner = low_corner | 1 << (2 - axis);
    Ints cut = inside[low_corner] ^ inside[high_corner];
    if constexpr (patched) cut &= is_equal(edges & any_lane(1u << e), 1 << e);
    count -= cut;
    const Floats low = v.corner(low_corner), high = v.corner(high_corner);
    const Floats at = smaller(larger(low / (low - high), all(0.01f)), all(0.99f));
    sum[axis] += where(cut, at);
    if (u == 1) sum[u_axis] += where(cut, all(1.0f));
    if (w == 1) sum[w_axis] += where(cut, all(1.0f));
  }
  const Floats edge_count = __builtin_convertvector(count, Floats);
  return ClusterVec3{sum[0], sum[1], sum[2]} / edge_count;
}

/// The direction in which distances grow: differences of the voxels around each corner, interpolated. Voxels
/// beside the cells are loaded where they are used, as there are more than registers.
MALLOW_INLINE ClusterVec3 normals_at(const EightCells& cells, const Corners& v, const ClusterVec3& in_cell) {
  const Floats wx[2] = {1.0f - in_cell.x, in_cell.x}, wy[2] = {1.0f - in_cell.y, in_cell.y},
               wz[2] = {1.0f - in_cell.z, in_cell.z};
  Floats w[8];
  ClusterVec3 g = {};
#pragma GCC unroll 8
  for (int c = 0; c < 8; ++c) {
    const Floats* const row = v.at[c >> 2][c >> 1 & 1] + (c & 1);
    w[c] = wx[c >> 2] * wy[c >> 1 & 1] * wz[c & 1];
    g.z += w[c] * (row[2] - row[0]);
  }
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
    const int i = k >> 1, j = k & 1, first = 4 * i + 2 * j;
    Floats beside[4];
    load_row(cells, 3 * i - 1, j, 0, beside);
    for (int c = first; c < first + 2; ++c)
      g.x += w[c] * (i == 0 ? v.corner(c | 4) - beside[c & 1] : beside[c & 1] - v.corner(c & 3));
    load_row(cells, i, 3 * j - 1, 0, beside);
    for (int c = first; c < first + 2; ++c)
      g.y += w[c] * (j == 0 ? v.corner(c | 2) - beside[c & 1] : beside[c & 1] - v.corner(c & 5));
  }
  const Floats square = squared(g);
  const Ints slope = is_larger(square, Floats{});
  const ClusterVec3 unit = where(slope, g / square_root(square));
  return {unit.x, unit.y, unit.z + where(~slope, all(1.0f))};
}

using Doubles = double __attribute__((vector_size(4 * sizeof(double))));

/// [m]; of a coordinate in voxels from the block's first one, whose own is `first`.
MALLOW_INLINE Floats to_world(const Floats& local, double first, double origin, double voxel_size) {
  Quad halves[2];
  __builtin_memcpy(halves, &local, sizeof halves);
  for (Quad& half : halves)
    half =
        __builtin_convertvector(origin + voxel_size * (first + __builtin_convertvector(half, Doubles)), Quad);
  return __builtin_shufflevector(halves[0], halves[1], 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Writes eight vectors, three floats each, and one float behind them.
MALLOW_INLINE void store_packed(const ClusterVec3& v, float* to) {
  Floats rows[4] = {v.x, v.y, v.z, v.z};
  transpose_halves(rows);
  for (std::size_t t = 0; t < 4; ++t) {
    const Quad low = __builtin_shufflevector(rows[t], rows[t], 0, 1, 2, 3);
    __builtin_memcpy(to + 3 * t, &low, sizeof low);
  }
  for (std::size_t t = 0; t < 4; ++t) {
    const Quad high = __builtin_shufflevector(rows[t], rows[t], 4, 5, 6, 7);
    __builtin_memcpy(to + 3 * (t + 4), &high, sizeof high);
  }
}
/// The same for the last vectors of a block: what is behind them may be another thread's.
void store_last(const ClusterVec3& v, std::size_t count, float* to) {
  float packed[3 * k_cluster + 1];
  store_packed(v, packed);
  __builtin_memcpy(to, packed, 3 * count * sizeof(float));
}

MALLOW_INLINE Ints widened(const std::uint16_t* from) {
  using Shorts = std::uint16_t __attribute__((vector_size(k_cluster * sizeof(std::uint16_t))));
  Shorts values;
  __builtin_memcpy(&values, from, sizeof values);
  return __builtin_convertvector(values, Ints);
}

template <bool patched>
void place(const VertexBlock& block, const VertexList& list, const VertexRows& to) {
  Padded padded;
  pad(block, padded);
  for (std::size_t i = 0; i < list.count; i += k_cluster) {
    const Ints cells = widened(list.cells + i);
    const Ints x = cells >> 6, y = cells >> 3 & 7, z = cells & 7;
    EightCells eight;
    eight.voxels = padded.at + Padded::k_first;
    store(x * Padded::k_plane + y * Padded::k_row + z, eight.at);
    Corners corners;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) load_row(eight, k >> 1, k & 1, -1, corners.at[k >> 1][k & 1]);
    Ints edges = {};
    if constexpr (patched) edges = widened(list.edges + i);
    const ClusterVec3 in_cell = middle_of_cuts<patched>(corners, edges);
    const ClusterVec3 normals = normals_at(eight, corners, in_cell);
    const ClusterVec3 local =
        in_cell + ClusterVec3{__builtin_convertvector(x, Floats), __builtin_convertvector(y, Floats),
                              __builtin_convertvector(z, Floats)};
    const ClusterVec3 vertices = {to_world(local.x, block.first[0], block.origin[0], block.voxel_size),
                                  to_world(local.y, block.first[1], block.origin[1], block.voxel_size),
                                  to_world(local.z, block.first[2], block.origin[2], block.voxel_size)};
    if (i + k_cluster < list.count) {
      store_packed(local, to.local + 3 * i);
      store_packed(vertices, to.vertices + 3 * i);
      store_packed(normals, to.normals + 3 * i);
    } else {
      store_last(local, list.count - i, to.local + 3 * i);
      store_last(vertices, list.count - i, to.vertices + 3 * i);
      store_last(normals, list.count - i, to.normals + 3 * i);
    }
  }
}

void place_vertices(const VertexBlock& block, const VertexList& list, const VertexRows& to) noexcept {
  if (list.edges == nullptr)
    place<false>(block, list, to);
  else
    place<true>(block, list, to);
}

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
    const Ints vertices = widened(blocks[1].vertex + row) + any_lane(blocks[1].first_vertex);
    store(vertices, table.at[0] + to);
    store(vertices, table.at[1] + to + 1);
  }
  if (blocks[0].vertex != nullptr)
    table.at[1][to] = blocks[0].first_vertex + blocks[0].vertex[row + k_side - 1];
}

void fill(const QuadBlock& block, VertexTable& table) {
  std::uint64_t slices[k_side];
  for (int x = 0; x < k_side; ++x)
    slices[x] = block.edges[0].at[x] | block.edges[1].at[x] | block.edges[2].at[x];
  const SetRanges set = find_ranges(slices);
  for (int x = set.x.first - 1; x <= set.x.last; ++x) {
    const QuadBlock::Cells* const blocks = block.around + (x < 0 ? 0 : 4);
    const int plane = (x & (k_side - 1)) * k_side * k_side;
    const int to = VertexTable::k_first + x * VertexTable::k_plane;
    if (set.y.first == 0) fill_row(blocks, plane + (k_side - 1) * k_side, to - VertexTable::k_row, table);
    for (int y = set.y.first == 0 ? 0 : set.y.first - 1; y <= set.y.last; ++y)
      fill_row(blocks + 2, plane + y * k_side, to + y * VertexTable::k_row, table);
  }
}

/// Returns whether there is any cell with more than one patch.
bool fill(const QuadBlock& block, PatchTable& table) {
  std::size_t count = 0;
  for (const QuadBlock::Cells& cells : block.around) count += cells.patched_count;
  if (count == 0) return false;
  __builtin_memset(&table, 0, sizeof table);
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

using QuadInts = int __attribute__((vector_size(16)));

MALLOW_INLINE Quad load_quad(const float* from) {
  Quad quad;
  __builtin_memcpy(&quad, from, sizeof quad);
  return quad;
}

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
  std::uint32_t vertex[4];
  Quad place[4];
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
    const int u = k_around[kind.outwards][k][0], v = k_around[kind.outwards][k][1];
    const int below = u << k_u | v << k_v;  // bit a: one below along axis a
    const std::ptrdiff_t cell = VertexTable::k_first + (slice.x - (below & 1)) * VertexTable::k_plane + bit -
                                (below >> 1 & 1) * VertexTable::k_row;
    vertex[k] = tables.vertices.at[below >> 2][cell];
    if constexpr (kind.patched)
      vertex[k] +=
          tables
              .patch_of_edge[tables.patches.at[below >> 2][cell] * k_cell_edges + 4 * kind.axis + 2 * u + v];
    place[k] = load_quad(tables.local + 3 * std::size_t{vertex[k]});
    if constexpr (kind.border) place[k] += load_quad(k_shift[walls & static_cast<unsigned>(below)]);
  }
  const QuadInts quad = QuadInts{static_cast<int>(vertex[0]), static_cast<int>(vertex[1]),
                                 static_cast<int>(vertex[2]), static_cast<int>(vertex[3])} +
                        slice.first_in_mesh;
  const Quad a = place[1] - place[3], b = place[0] - place[2];
  const Quad xy = __builtin_shufflevector(a, b, 0, 4, 1, 5), z = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Quad squares = xy * xy, z_squares = z * z;
  const Quad lengths = squares + (__builtin_shufflevector(squares, squares, 2, 3, 2, 3) + z_squares);
  const QuadInts other = __builtin_shufflevector(lengths, lengths, 0, 0, 0, 0) <
                         0.99f * __builtin_shufflevector(lengths, lengths, 1, 1, 1, 1);
  return other ? __builtin_shufflevector(quad, quad, 1, 2, 3, 0) : quad;
}

/// Writes the quads of some edges of a kind, each behind those of all cells before and of axes before.
template <EdgeKind kind>
MALLOW_INLINE void write_kind(const QuadTables& tables, const EdgeSlice& slice, std::uint64_t some) {
  for (; some != 0; some &= some - 1) {
    const std::uint64_t through = some ^ (some - 1), below = through >> 1;
    const int before = __builtin_popcountll(slice.edges[0] & (kind.axis > 0 ? through : below)) +
                       __builtin_popcountll(slice.edges[1] & (kind.axis > 1 ? through : below)) +
                       __builtin_popcountll(slice.edges[2] & below);
    const QuadInts quad = quad_of<kind>(tables, slice, __builtin_ctzll(some));
    const QuadInts one = __builtin_shufflevector(quad, quad, 0, 1, 2, 0),
                   two = __builtin_shufflevector(quad, quad, 2, 3, 2, 3);
    std::uint32_t* const to = slice.to + 6 * static_cast<std::ptrdiff_t>(before);
    __builtin_memcpy(to, &one, sizeof one);
    __builtin_memcpy(to + 4, &two, sizeof two / 2);
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
                             QuadInts{} + static_cast<int>(block.first_in_mesh),
                             to};
    if ((slice.edges[0] | slice.edges[1] | slice.edges[2]) == 0) continue;
    write_axis<0, patched>(tables, slice, block.inside->at[x]);
    write_axis<1, patched>(tables, slice, block.inside->at[x]);
    write_axis<2, patched>(tables, slice, block.inside->at[x]);
    for (const std::uint64_t edges : slice.edges) to += 6 * __builtin_popcountll(edges);
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

extern const MeshLanes mesh_lanes;
const MeshLanes mesh_lanes = {place_vertices, write_quads};

}  // namespace mallow::MALLOW_LEVEL

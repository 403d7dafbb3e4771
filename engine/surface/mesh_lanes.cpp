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

/// From the first bit that is set to the last.
struct BitRange {
  int first, last;
};

void pad_rows(const float* const* blocks, int from, int x, int y, int end_y, Padded& padded) {
  const float *const below = blocks[0], *const here = blocks[1], *const above = blocks[2];
  float* to = padded.at + Padded::k_first + x * Padded::k_plane + y * Padded::k_row;
  for (; y < end_y; ++y, from += k_side, to += Padded::k_row) {
    to[-1] = below[from + k_side - 1];
    store(load(here + from), to);
    __builtin_memcpy(to + k_side, above + from, 2 * sizeof(float));
  }
}

/// Copies what the cells in a range along x and y need.
void pad(const VertexBlock& block, Padded& padded) {
  std::uint64_t all = 0;
  BitRange x{k_side, 0};
  for (int i = 0; i < k_side; ++i) {
    all |= block.cut->at[i];
    if (block.cut->at[i] == 0) continue;
    if (x.first == k_side) x.first = i;
    x.last = i;
  }
  const BitRange y{__builtin_ctzll(all) / k_side, (63 - __builtin_clzll(all)) / k_side};
  const int end_y = y.last + 3;
  for (int i = x.first - 1; i <= x.last + 2; ++i) {
    const int plane = (i & (k_side - 1)) * k_side * k_side;
    const float* const* const blocks = block.distances + 9 * (i < 0 ? 0 : i < k_side ? 1 : 2);
    if (y.first == 0) pad_rows(blocks, plane + (k_side - 1) * k_side, i, -1, 0, padded);
    const int first = y.first == 0 ? 0 : y.first - 1;
    pad_rows(blocks + 3, plane + first * k_side, i, first, end_y < k_side ? end_y : k_side, padded);
    pad_rows(blocks + 6, plane, i, k_side, end_y, padded);
  }
}

/// The distances about eight cells, a lane each, from voxels at −1 to 2 along each axis: those that are next
/// to a corner along some axis.
struct Around {
  Floats inner[2][2][4];     ///< [x][y][z + 1]
  Floats beside_x[2][2][2];  ///< x of −1 and 2, [y][z]
  Floats beside_y[2][2][2];  ///< [x], y of −1 and 2, [z]
  const Floats& corner(int c) const { return inner[c >> 2][c >> 1 & 1][1 + (c & 1)]; }
};

MALLOW_INLINE void load_around(const float* voxels, const std::uint32_t* cells, Around& v) {
  constexpr int k_plane = Padded::k_plane, k_row = Padded::k_row;
  const auto two = [&](int x, int y, Floats* to) {
    Floats row[4];
    load_named(voxels + x * k_plane + y * k_row, 1, cells, row);
    to[0] = row[0];
    to[1] = row[1];
  };
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
#pragma GCC unroll 2
    for (int j = 0; j < 2; ++j) {
      load_named(voxels + i * k_plane + j * k_row - 1, 1, cells, v.inner[i][j]);
      two(3 * i - 1, j, v.beside_x[i][j]);
      two(i, 3 * j - 1, v.beside_y[i][j]);
    }
  }
}

MALLOW_INLINE Ints any_lane(std::uint32_t value) {
  return Ints{} + static_cast<int>(value);
}

/// The mean of where the surface cuts the edges of patches, from the cells' lowest corners on. Never at a
/// corner, as cells that share it would put their vertices in one place. edges: a bit each of those of the
/// patch; the others of its cell count for nothing.
template <bool patched>
MALLOW_INLINE ClusterVec3 middle_of_cuts(const Around& v, [[maybe_unused]] const Ints& edges) {
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

/// The direction in which distances grow: differences of the voxels around each corner, interpolated.
MALLOW_INLINE ClusterVec3 normals_at(const Around& v, const ClusterVec3& in_cell) {
  const Floats wx[2] = {1.0f - in_cell.x, in_cell.x}, wy[2] = {1.0f - in_cell.y, in_cell.y},
               wz[2] = {1.0f - in_cell.z, in_cell.z};
  ClusterVec3 g = {};
#pragma GCC unroll 8
  for (int c = 0; c < 8; ++c) {
    const int x = c >> 2, y = c >> 1 & 1, z = c & 1;
    const Floats w = wx[x] * wy[y] * wz[z];
    const Floats along_x =
        x == 0 ? v.corner(c | 4) - v.beside_x[0][y][z] : v.beside_x[1][y][z] - v.corner(c & 3);
    const Floats along_y =
        y == 0 ? v.corner(c | 2) - v.beside_y[x][0][z] : v.beside_y[x][1][z] - v.corner(c & 5);
    g += w * ClusterVec3{along_x, along_y, v.inner[x][y][z + 2] - v.inner[x][y][z]};
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
    std::uint32_t places[k_cluster];
    store(x * Padded::k_plane + y * Padded::k_row + z, places);
    Around around;
    load_around(padded.at + Padded::k_first, places, around);
    Ints edges = {};
    if constexpr (patched) edges = widened(list.edges + i);
    const ClusterVec3 in_cell = middle_of_cuts<patched>(around, edges);
    const ClusterVec3 normals = normals_at(around, in_cell);
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

/// The first vertices of the cells around a block's edges: cells at −1 to 7 along each axis. A row of cells
/// lies at 4 to 11.
struct VertexTable {
  static constexpr int k_row = 12, k_plane = (k_side + 1) * k_row, k_first = k_plane + k_row + 4,
                       k_size = (k_side + 1) * k_plane;
  std::uint32_t at[k_size];
};

MALLOW_INLINE void fill_row(const QuadBlock::Cells* blocks, int row, std::uint32_t* to) {
  if (blocks[0].vertex != nullptr) to[-1] = blocks[0].first_vertex + blocks[0].vertex[row + k_side - 1];
  if (blocks[1].vertex != nullptr)
    store(widened(blocks[1].vertex + row) + any_lane(blocks[1].first_vertex), to);
}

void fill(const QuadBlock& block, VertexTable& table) {
  std::uint64_t all = 0;
  int first = k_side, last = 0;
  for (int x = 0; x < k_side; ++x) {
    const std::uint64_t word = block.edges[0].at[x] | block.edges[1].at[x] | block.edges[2].at[x];
    all |= word;
    if (word == 0) continue;
    if (first == k_side) first = x;
    last = x;
  }
  const BitRange y{__builtin_ctzll(all) / k_side, (63 - __builtin_clzll(all)) / k_side};
  for (int x = first - 1; x <= last; ++x) {
    const QuadBlock::Cells* const blocks = block.around + (x < 0 ? 0 : 4);
    const int plane = (x & (k_side - 1)) * k_side * k_side;
    std::uint32_t* const to = table.at + VertexTable::k_first + x * VertexTable::k_plane;
    if (y.first == 0) fill_row(blocks, plane + (k_side - 1) * k_side, to - VertexTable::k_row);
    for (int j = y.first == 0 ? 0 : y.first - 1; j <= y.last; ++j)
      fill_row(blocks + 2, plane + j * k_side, to + j * VertexTable::k_row);
  }
}

/// Which of k_cell_patches the cells with more than one patch have, in the places of VertexTable; the others
/// have number 0, whose edges are all of one patch.
struct PatchTable {
  std::uint16_t at[VertexTable::k_size];
};

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
      table.at[VertexTable::k_first + x * VertexTable::k_plane + y * VertexTable::k_row + z] =
          cells.patched[i].patches;
    }
  }
  return true;
}

/// The four cells around an edge, counter-clockwise seen from outside.
struct QuadStep {
  std::int16_t cell[4];   ///< in VertexTable, from the edge's row on
  std::uint8_t below[4];  ///< bit a: one below the edge along axis a
  std::uint8_t edge[4];   ///< which of the cell's edges it is
};
struct QuadSteps {
  QuadStep at[2][3 * k_side];  ///< [whether the edge leads outside][3 z + axis]
};
constexpr QuadSteps find_steps() {
  constexpr int k_steps[3] = {VertexTable::k_plane, VertexTable::k_row, 1};
  QuadSteps steps{};
  for (int outwards = 0; outwards < 2; ++outwards) {
    for (int e = 0; e < 3 * k_side; ++e) {
      const int axis = e % 3, u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
      for (int k = 0; k < 4; ++k) {
        // Counter-clockwise seen from where the edge leads; where that is inside, the other way round.
        constexpr int k_around[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
        const int u = k_around[k][0], v = k_around[k][1], to = outwards ? k : (4 - k) % 4;
        QuadStep& step = steps.at[outwards][e];
        step.cell[to] = static_cast<std::int16_t>(e / 3 - u * k_steps[u_axis] - v * k_steps[v_axis]);
        step.below[to] = static_cast<std::uint8_t>(u << u_axis | v << v_axis);
        step.edge[to] = static_cast<std::uint8_t>(4 * axis + 2 * u + v);
      }
    }
  }
  return steps;
}
constexpr QuadSteps k_steps = find_steps();

/// By a row of bits: bit z at 3 z.
struct SpreadBits {
  std::uint32_t at[256];
};
constexpr SpreadBits find_spread() {
  SpreadBits spread{};
  for (unsigned row = 0; row < 256; ++row)
    for (int z = 0; z < k_side; ++z) spread.at[row] |= (row >> z & 1) << (3 * z);
  return spread;
}
constexpr SpreadBits k_spread = find_spread();

/// By a bit each axis: a block below along these.
constexpr float k_shift[8][4] = {{0, 0, 0},  {-8, 0, 0},  {0, -8, 0},  {-8, -8, 0},
                                 {0, 0, -8}, {-8, 0, -8}, {0, -8, -8}, {-8, -8, -8}};

using QuadInts = int __attribute__((vector_size(16)));

MALLOW_INLINE Quad load_quad(const float* from) {
  Quad quad;
  __builtin_memcpy(&quad, from, sizeof quad);
  return quad;
}

/// The vertices of an edge's quad, turned so that its shorter diagonal is from the first to the third. Ties,
/// as on flat faces, are not left to rounding. first: its row in the tables. walls: the axes along which
/// cells below are in another block.
template <bool patched, bool border>
MALLOW_INLINE QuadInts quad_of(const QuadBlock& block, const VertexTable& vertices,
                               [[maybe_unused]] const PatchTable& patches, std::ptrdiff_t first,
                               const QuadStep& step, [[maybe_unused]] unsigned walls) {
  std::uint32_t v[4];
  Quad place[4];
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
    const std::ptrdiff_t cell = first + step.cell[k];
    v[k] = vertices.at[cell];
    if constexpr (patched)
      v[k] += block.patch_of_edge[std::size_t{patches.at[cell]} * k_cell_edges + step.edge[k]];
    place[k] = load_quad(block.local + 3 * std::size_t{v[k]});
    if constexpr (border) place[k] += load_quad(k_shift[step.below[k] & walls]);
  }
  const Quad a = place[1] - place[3], b = place[0] - place[2];
  const Quad xy = __builtin_shufflevector(a, b, 0, 4, 1, 5), zz = __builtin_shufflevector(a, b, 2, 6, 2, 6);
  const Quad squares = xy * xy, z_squares = zz * zz;
  const Quad lengths = squares + (__builtin_shufflevector(squares, squares, 2, 3, 2, 3) + z_squares);
  const QuadInts turned = __builtin_shufflevector(lengths, lengths, 0, 0, 0, 0) <
                          0.99f * __builtin_shufflevector(lengths, lengths, 1, 1, 1, 1);
  const QuadInts quad = {static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2]),
                         static_cast<int>(v[3])};
  return turned ? __builtin_shufflevector(quad, quad, 1, 2, 3, 0) : quad;
}

template <bool patched>
void write(const QuadBlock& block, const VertexTable& vertices, const PatchTable& patches,
           std::uint32_t* to) {
  const auto& edges = block.edges;
  const QuadInts in_mesh = QuadInts{} + static_cast<int>(block.first_in_mesh);
  for (int x = 0; x < k_side; ++x) {
    std::uint64_t left = edges[0].at[x] | edges[1].at[x] | edges[2].at[x];
    while (left != 0) {
      const int y = __builtin_ctzll(left) / k_side, row = y * k_side;
      left &= ~(std::uint64_t{255} << row);
      const auto spread = [&](const BlockBits& bits) { return k_spread.at[bits.at[x] >> row & 255]; };
      const std::uint32_t cut = spread(edges[0]) | spread(edges[1]) << 1 | spread(edges[2]) << 2;
      const std::uint32_t outwards = spread(*block.inside) * 7;
      const std::ptrdiff_t first = VertexTable::k_first + x * VertexTable::k_plane + y * VertexTable::k_row;
      const unsigned walls = (x == 0 ? 1u : 0u) | (y == 0 ? 2u : 0u);
      const auto each = [&](std::uint32_t some, const auto& find) {
        for (; some != 0; some &= some - 1) {
          const int e = __builtin_ctz(some);
          const QuadInts quad = find(k_steps.at[outwards >> e & 1][e]) + in_mesh;
          const QuadInts one = __builtin_shufflevector(quad, quad, 0, 1, 2, 0);
          const QuadInts two = __builtin_shufflevector(quad, quad, 2, 3, 2, 3);
          __builtin_memcpy(to, &one, sizeof one);
          __builtin_memcpy(to + 4, &two, sizeof two / 2);
          to += 6;
        }
      };
      const auto in_block = [&](const QuadStep& step) {
        return quad_of<patched, false>(block, vertices, patches, first, step, 0);
      };
      const auto at_walls = [&](unsigned of) {
        return [&, of](const QuadStep& step) {
          return quad_of<patched, true>(block, vertices, patches, first, step, of);
        };
      };
      each(cut & 7, at_walls(walls | 4));
      if (walls == 0)
        each(cut & ~7u, in_block);
      else
        each(cut & ~7u, at_walls(walls));
    }
  }
}

void write_quads(const QuadBlock& block, std::uint32_t* triangles) noexcept {
  VertexTable vertices;
  PatchTable patches;
  fill(block, vertices);
  if (fill(block, patches))
    write<true>(block, vertices, patches, triangles);
  else
    write<false>(block, vertices, patches, triangles);
}

}  // namespace

extern const MeshLanes mesh_lanes;
const MeshLanes mesh_lanes = {place_vertices, write_quads};

}  // namespace mallow::MALLOW_LEVEL

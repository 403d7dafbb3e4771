// Vertices and normals of dual marching cubes (Nielson 2004; see cut_cells.h), eight at a time, a lane each.
#include "surface/vertex_lanes.h"

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

void pad_rows(const float* const* blocks, int from, int x, int y, int end_y, Padded& padded) {
  const float *const below = blocks[0], *const here = blocks[1], *const above = blocks[2];
  float* to = padded.at + Padded::k_first + x * Padded::k_plane + y * Padded::k_row;
  for (; y < end_y; ++y, from += k_side, to += Padded::k_row) {
    to[-1] = below[from + k_side - 1];
    store(load(here + from), to);
    copy_bytes(to + k_side, above + from, 2 * sizeof(float));
  }
}

/// Copies what the cells with vertices need.
void pad(const VertexBlock& block, Padded& padded) {
  const BitRange range = block.range;
  const int end_y = range.last_y + 3;
  for (int x = range.first_x - 1; x <= range.last_x + 2; ++x) {
    const int plane = (x & (k_side - 1)) * k_side * k_side;
    const float* const* const blocks = block.distances + 9 * (x < 0 ? 0 : x < k_side ? 1 : 2);
    if (range.first_y == 0) pad_rows(blocks, plane + (k_side - 1) * k_side, x, -1, 0, padded);
    const int first = range.first_y == 0 ? 0 : range.first_y - 1;
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
    if constexpr (patched) cut &= is_equal(edges & static_cast<int>(1u << e), 1 << e);
    count -= cut;
    const Floats low = v.corner(low_corner), high = v.corner(high_corner);
    const Floats at = smaller(larger(low / (low - high), all(0.01f)), all(0.99f));
    sum[axis] += where(cut, at);
    if (u == 1) sum[u_axis] += where(cut, all(1.0f));
    if (w == 1) sum[w_axis] += where(cut, all(1.0f));
  }
  const Floats edge_count = converted<Floats>(count);
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

using Doubles = VectorOf<double, 4>;

/// [m]; of a coordinate in voxels from the block's first one, whose own is `first`.
MALLOW_INLINE Floats to_world(const Floats& local, double first, double origin, double voxel_size) {
  Quad halves[2];
  copy_bytes(halves, &local, sizeof halves);
  for (Quad& half : halves) half = converted<Quad>(origin + voxel_size * (first + converted<Doubles>(half)));
  return shuffled<0, 1, 2, 3, 4, 5, 6, 7>(halves[0], halves[1]);
}

/// Writes eight vectors, three floats each, and one float behind them.
MALLOW_INLINE void store_packed(const ClusterVec3& v, float* to) {
  Floats rows[4] = {v.x, v.y, v.z, v.z};
  transpose_halves(rows);
  for (std::size_t t = 0; t < 4; ++t) {
    const Quad low = shuffled<0, 1, 2, 3>(rows[t]);
    copy_bytes(to + 3 * t, &low, sizeof low);
  }
  for (std::size_t t = 0; t < 4; ++t) {
    const Quad high = shuffled<4, 5, 6, 7>(rows[t]);
    copy_bytes(to + 3 * (t + 4), &high, sizeof high);
  }
}
/// The same for the last vectors of a block: what is behind them may be another thread's.
void store_last(const ClusterVec3& v, std::size_t count, float* to) {
  float packed[3 * k_cluster + 1];
  store_packed(v, packed);
  copy_bytes(to, packed, 3 * count * sizeof(float));
}

template <bool patched>
void place(const VertexBlock& block, const VertexList& list, const VertexRows& to) {
  Padded padded;
  pad(block, padded);
  for (std::size_t i = 0; i < list.count; i += k_cluster) {
    const Ints cells = load(list.cells + i);
    const Ints x = cells >> 6, y = cells >> 3 & 7, z = cells & 7;
    EightCells eight;
    eight.voxels = padded.at + Padded::k_first;
    store(x * Padded::k_plane + y * Padded::k_row + z, eight.at);
    Corners corners;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) load_row(eight, k >> 1, k & 1, -1, corners.at[k >> 1][k & 1]);
    Ints edges = {};
    if constexpr (patched) edges = load(list.edges + i);
    const ClusterVec3 in_cell = middle_of_cuts<patched>(corners, edges);
    const ClusterVec3 normals = normals_at(eight, corners, in_cell);
    const ClusterVec3 local =
        in_cell + ClusterVec3{converted<Floats>(x), converted<Floats>(y), converted<Floats>(z)};
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

}  // namespace

extern const VertexLanes vertex_lanes;
const VertexLanes vertex_lanes = {place_vertices};

}  // namespace mallow::MALLOW_LEVEL

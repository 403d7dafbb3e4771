#include "level_set/dual_mesher.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/parallel.h"
#include "level_set/dual_cells.h"

namespace mallow {
namespace {

constexpr std::size_t k_blocks_at_once = 8;
constexpr int k_side = k_block_side;

int cell_at(int x, int y, int z) {
  return (x * k_side + y) * k_side + z;
}
/// Whether the edge from a cell's lowest corner along an axis is cut.
bool cuts_edge(unsigned inside, int axis) {
  return (inside & 1) != (inside >> (1 << (2 - axis)) & 1);
}

/// Calls visit(cell, x, y, z) for the cells that are cut, by the corners inside of all 512.
template <class Visit>
void for_each_cut(const std::array<std::uint8_t, k_block_voxels>& inside, const Visit& visit) {
  for (int row = 0; row < k_side * k_side; ++row) {
    std::uint64_t cells;
    std::memcpy(&cells, inside.data() + row * k_side, sizeof cells);
    if (cells == 0 || cells == UINT64_MAX) continue;
    for (int z = 0; z < k_side; ++z) {
      const auto cell = static_cast<std::size_t>(row * k_side + z);
      if (inside[cell] != 0 && inside[cell] != 255) visit(cell, row / k_side, row % k_side, z);
    }
  }
}

/// A block's distances with one more below and two above along each axis, z fastest.
class Padded {
 public:
  static constexpr int k_row = k_block_side + 3, k_plane = k_row * k_row;
  float at[k_row * k_plane];

  float* voxel(int x, int y, int z) { return at + (x + 1) * k_plane + (y + 1) * k_row + z + 1; }

  Padded(const SurfaceField& field, std::uint32_t block) {
    // Voxels that come from the neighbour below, the block itself and the one above, and where they go.
    struct Range {
      int from, count, to;
    };
    constexpr Range k_ranges[3] = {{k_side - 1, 1, -1}, {0, k_side, 0}, {0, 2, k_side}};
    for (int bx = 0; bx < 3; ++bx) {
      for (int by = 0; by < 3; ++by) {
        const float* blocks[3];
        for (int bz = 0; bz < 3; ++bz)
          blocks[bz] = distances_of(field, field.neighbors(block)[neighbor_slot(bx - 1, by - 1, bz - 1)]);
        const Range &rx = k_ranges[bx], &ry = k_ranges[by];
        for (int x = 0; x < rx.count; ++x) {
          for (int y = 0; y < ry.count; ++y) {
            const int row = cell_at(rx.from + x, ry.from + y, 0);
            float* const to = voxel(rx.to + x, ry.to + y, 0);
            to[-1] = blocks[0][row + k_side - 1];
            std::memcpy(to, blocks[1] + row, k_side * sizeof(float));
            to[k_side] = blocks[2][row];
            to[k_side + 1] = blocks[2][row + 1];
          }
        }
      }
    }
  }

 private:
  static const float* distances_of(const SurfaceField& field, std::uint32_t block) {
    if (block != k_no_block && field.kind(block) == BlockKind::surface) return field.distances(block);
    static const std::vector<float> outside(k_block_voxels, SurfaceField::k_background),
        inside(k_block_voxels, -SurfaceField::k_background);
    return (block != k_no_block && field.kind(block) == BlockKind::inside ? inside : outside).data();
  }
};

/// The direction in which distances grow at a place in the cell above a voxel: differences of the voxels
/// around each corner, interpolated.
Vec3 normal_at(const float* voxel, const Eigen::Vector3f& in_cell) {
  const float wx[2] = {1 - in_cell.x(), in_cell.x()}, wy[2] = {1 - in_cell.y(), in_cell.y()},
              wz[2] = {1 - in_cell.z(), in_cell.z()};
  float gx = 0, gy = 0, gz = 0;
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      for (int z = 0; z < 2; ++z) {
        const float* const c = voxel + x * Padded::k_plane + y * Padded::k_row + z;
        const float w = wx[x] * wy[y] * wz[z];
        gx += w * (c[Padded::k_plane] - c[-Padded::k_plane]);
        gy += w * (c[Padded::k_row] - c[-Padded::k_row]);
        gz += w * (c[1] - c[-1]);
      }
    }
  }
  const Vec3 g(gx, gy, gz);
  return g.squaredNorm() > 0 ? Vec3(g.normalized()) : Vec3(Vec3::UnitZ());
}

/// An edge of a cell: its corners as steps in Padded, and how far along x, y and z the lower one is.
struct CellEdge {
  int low, high;
  float x, y, z;
};
constexpr std::array<CellEdge, k_cell_edges> cell_edges() {
  std::array<CellEdge, k_cell_edges> edges{};
  const auto step = [](int corner) {
    return (corner >> 2) * Padded::k_plane + (corner >> 1 & 1) * Padded::k_row + (corner & 1);
  };
  for (std::size_t e = 0; e < k_cell_edges; ++e) {
    const EdgeCorners c = edge_corners(static_cast<int>(e));
    edges[e] = {step(c.low), step(c.high), static_cast<float>(c.low >> 2), static_cast<float>(c.low >> 1 & 1),
                static_cast<float>(c.low & 1)};
  }
  return edges;
}
constexpr std::array<CellEdge, k_cell_edges> k_edges = cell_edges();

/// The mean of where the surface cuts a patch's edges, from the cell's lowest corner on. Never at a corner,
/// as cells that share it would put their vertices in one place.
Eigen::Vector3f middle_of_cuts(unsigned edges, const float* voxel) {
  float sum[3] = {0, 0, 0};
  const auto count = static_cast<float>(std::popcount(edges));
  for (; edges != 0; edges &= edges - 1) {
    const int e = std::countr_zero(edges);
    const CellEdge& edge = k_edges[static_cast<std::size_t>(e)];
    const float low = voxel[edge.low], high = voxel[edge.high];
    sum[0] += edge.x;
    sum[1] += edge.y;
    sum[2] += edge.z;
    sum[e / 4] += std::clamp(low / (low - high), 0.01f, 0.99f);
  }
  return Eigen::Vector3f(sum[0], sum[1], sum[2]) / count;
}

}  // namespace

const DualMesher::Cells& DualMesher::cells_of(std::size_t at, const Eigen::Vector3i& offset) const {
  return cells_[neighbors_[at][neighbor_slot(offset.x(), offset.y(), offset.z())]];
}

/// Surface blocks, and those below them, whose last cells reach into one.
void DualMesher::choose_blocks(const SurfaceField& field) {
  const auto n = static_cast<std::uint32_t>(field.blocks().size());
  blocks_.clear();
  place_.assign(n, k_no_block);
  for (std::uint32_t b = 0; b < n; ++b) {
    bool cut = false;
    for (int x = 0; x <= 1; ++x)
      for (int y = 0; y <= 1; ++y)
        for (int z = 0; z <= 1; ++z) {
          const std::uint32_t above = field.neighbors(b)[neighbor_slot(x, y, z)];
          cut = cut || (above != k_no_block && field.kind(above) == BlockKind::surface);
        }
    if (!cut) continue;
    place_[b] = static_cast<std::uint32_t>(blocks_.size());
    blocks_.push_back(b);
  }
}

void DualMesher::find_signs(const SurfaceField& field, std::size_t at) {
  const std::uint32_t block = blocks_[at];
  for (std::size_t k = 0; k < neighbors_[at].size(); ++k) {
    const std::uint32_t other = field.neighbors(block)[k];
    neighbors_[at][k] = other == k_no_block ? k_no_block : place_[other];
  }
  if (field.kind(block) != BlockKind::surface) {
    signs_[at].fill(field.kind(block) == BlockKind::inside ? 255 : 0);
    return;
  }
  const float* const distances = field.distances(block);
  for (std::size_t row = 0; row < signs_[at].size(); ++row) {
    unsigned bits = 0;
    for (std::size_t z = 0; z < k_side; ++z) bits |= (distances[row * k_side + z] < 0 ? 1u : 0u) << z;
    signs_[at][row] = static_cast<std::uint8_t>(bits);
  }
}

/// Which corners of a block's cells are inside.
void DualMesher::find_corners(const SurfaceField& field, std::size_t at) {
  constexpr unsigned k_all = (1u << (k_side + 1)) - 1;
  // Nine voxels of nine by nine rows, a bit each.
  unsigned rows[k_side + 1][k_side + 1];
  for (int x = 0; x <= k_side; ++x) {
    for (int y = 0; y <= k_side; ++y) {
      const int row = x % k_side * k_side + y % k_side;
      const auto bits = [&](int bz) -> unsigned {
        const std::size_t slot = neighbor_slot(x / k_side, y / k_side, bz);
        if (const std::uint32_t other = neighbors_[at][slot]; other != k_no_block)
          return signs_[other][static_cast<std::size_t>(row)];
        const std::uint32_t block = field.neighbors(blocks_[at])[slot];
        return block != k_no_block && field.kind(block) == BlockKind::inside ? 255 : 0;
      };
      rows[x][y] = bits(0) | (bits(1) & 1) << k_side;
    }
  }
  for (int x = 0; x < k_side; ++x) {
    for (int y = 0; y < k_side; ++y) {
      std::uint8_t* const to = cells_[at].inside.data() + cell_at(x, y, 0);
      const unsigned a = rows[x][y], b = rows[x][y + 1], c = rows[x + 1][y], d = rows[x + 1][y + 1];
      if (a == b && a == c && a == d && (a == 0 || a == k_all)) {
        std::memset(to, a == 0 ? 0 : 255, k_side);
        continue;
      }
      // Corners 0 and 1 are voxels z and z + 1 of row (x, y), and so on.
      for (int z = 0; z < k_side; ++z)
        to[z] = static_cast<std::uint8_t>((a >> z & 3) | (b >> z & 3) << 2 | (c >> z & 3) << 4 |
                                          (d >> z & 3) << 6);
    }
  }
}

/// Decides which patches of ambiguous cells are joined, and counts vertices and quads.
void DualMesher::count(std::size_t at) {
  Cells& cells = cells_[at];
  cells.vertices = cells.quads = 0;
  for_each_cut(cells.inside, [&](std::size_t cell, int x, int y, int z) {
    const unsigned inside = cells.inside[cell];
    unsigned patches = inside;
    if (const int face = k_cell_patches[inside].twice; face >= 0) {
      const int axis = face / 2, step = face % 2 ? 1 : -1;
      Eigen::Vector3i other(x, y, z), block(0, 0, 0);
      other[axis] += step;
      if (other[axis] < 0 || other[axis] == k_side) block[axis] = step;
      other[axis] = (other[axis] + k_side) % k_side;
      const auto there = static_cast<std::size_t>(cell_at(other.x(), other.y(), other.z()));
      if (k_cell_patches[cells_of(at, block).inside[there]].twice == (face ^ 1)) patches += 256;
    }
    cells.patches[cell] = static_cast<std::uint16_t>(patches);
    cells.vertex[cell] = static_cast<std::uint16_t>(cells.vertices);
    cells.vertices += static_cast<std::uint32_t>(k_cell_patches[patches].count);
    for (int axis = 0; axis < 3; ++axis) cells.quads += cuts_edge(inside, axis);
  });
}

void DualMesher::place_vertices(const SurfaceField& field, std::size_t at, Mesh& mesh) {
  const Cells& cells = cells_[at];
  if (cells.vertices == 0) return;
  Padded padded(field, blocks_[at]);
  const Eigen::Vector3d corner = k_side * field.blocks().blocks()[blocks_[at]].cast<double>();
  std::uint32_t next = cells.first_vertex;
  for_each_cut(cells.inside, [&](std::size_t cell, int x, int y, int z) {
    const float* const voxel = padded.voxel(x, y, z);
    const CellPatches& patches = k_cell_patches[cells.patches[cell]];
    for (int patch = 0; patch < patches.count; ++patch, ++next) {
      const Eigen::Vector3f in_cell = middle_of_cuts(patches.edges[static_cast<std::size_t>(patch)], voxel);
      const Eigen::Vector3f local = in_cell + Eigen::Vector3i(x, y, z).cast<float>();
      local_[next - first_vertex_] = local;
      mesh.vertices[next] = field.frame().point(corner + local.cast<double>());
      mesh.normals[next] = normal_at(voxel, in_cell);
    }
  });
}

/// The two triangles of every edge that is cut and starts at a voxel of the block.
void DualMesher::write_triangles(std::size_t at, Mesh& mesh) const {
  const Cells& cells = cells_[at];
  if (cells.quads == 0) return;
  auto* to = mesh.triangles.data() + first_triangle_ + 2 * static_cast<std::size_t>(cells.first_quad);
  for_each_cut(cells.inside, [&](std::size_t cell, int x, int y, int z) {
    const unsigned inside = cells.inside[cell];
    for (int axis = 0; axis < 3; ++axis) {
      if (!cuts_edge(inside, axis)) continue;
      // The cells around the edge, counter-clockwise seen from where it leads.
      constexpr int k_around[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
      constexpr int k_steps[3] = {k_side * k_side, k_side, 1};
      const int u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
      const int at_u = u_axis == 0 ? x : u_axis == 1 ? y : z, at_v = v_axis == 0 ? x : v_axis == 1 ? y : z;
      std::array<std::uint32_t, 4> q;
      std::array<Eigen::Vector3f, 4> place;
      for (std::size_t k = 0; k < 4; ++k) {
        const int u = k_around[k][0], v = k_around[k][1];
        int there = static_cast<int>(cell) - u * k_steps[u_axis] - v * k_steps[v_axis];
        const Cells* of = &cells;
        Eigen::Vector3i block(0, 0, 0);
        if (u > at_u || v > at_v) {
          block[u_axis] = u > at_u ? -1 : 0;
          block[v_axis] = v > at_v ? -1 : 0;
          there -= k_side * (block[u_axis] * k_steps[u_axis] + block[v_axis] * k_steps[v_axis]);
          of = &cells_of(at, block);
        }
        const auto c = static_cast<std::size_t>(there);
        const int patch =
            k_cell_patches[of->patches[c]].of_edge[static_cast<std::size_t>(4 * axis + 2 * u + v)];
        q[k] = of->first_vertex + of->vertex[c] + static_cast<std::uint32_t>(patch);
        place[k] = local(q[k]) + (k_side * block).cast<float>();
      }
      if (!(inside & 1)) std::swap(q[1], q[3]);
      // Along the shorter diagonal; ties, as on flat faces, are not left to rounding.
      if ((place[1] - place[3]).squaredNorm() < 0.99f * (place[0] - place[2]).squaredNorm())
        std::rotate(q.begin(), q.begin() + 1, q.end());
      *to++ = {q[0], q[1], q[2]};
      *to++ = {q[0], q[2], q[3]};
    }
  });
}

void DualMesher::append(const SurfaceField& field, int threads, MeshCounts& counts, Mesh& mesh) {
  choose_blocks(field);
  cells_.resize(blocks_.size());
  signs_.resize(blocks_.size());
  neighbors_.resize(blocks_.size());
  const auto each = [&](const auto& work) {
    parallel_for(
        threads, blocks_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t at = begin; at < end; ++at) work(at);
        },
        k_blocks_at_once);
  };
  each([&](std::size_t at) { find_signs(field, at); });
  each([&](std::size_t at) { find_corners(field, at); });
  each([&](std::size_t at) { count(at); });
  first_vertex_ = static_cast<std::uint32_t>(counts.vertices);
  first_triangle_ = counts.triangles;
  std::uint32_t vertices = first_vertex_, quads = 0;
  block_vertices_.clear();
  for (std::size_t at = 0; at < blocks_.size(); ++at) {
    Cells& cells = cells_[at];
    cells.first_vertex = vertices;
    cells.first_quad = quads;
    vertices += cells.vertices;
    quads += cells.quads;
    if (cells.vertices > 0) block_vertices_.push_back({blocks_[at], cells.first_vertex, cells.vertices});
  }
  counts = {vertices, first_triangle_ + 2 * static_cast<std::size_t>(quads)};
  mesh.vertices.resize(counts.vertices);
  mesh.normals.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  local_.resize(vertices - first_vertex_);
  each([&](std::size_t at) { place_vertices(field, at, mesh); });
  each([&](std::size_t at) { write_triangles(at, mesh); });
}

std::size_t DualMesher::bytes() const {
  return cells_.capacity() * sizeof(Cells) + signs_.capacity() * sizeof(SignRows) +
         neighbors_.capacity() * sizeof neighbors_[0] + local_.capacity() * sizeof local_[0] +
         (blocks_.capacity() + place_.capacity()) * sizeof(std::uint32_t) +
         block_vertices_.capacity() * sizeof(BlockVertices);
}

}  // namespace mallow

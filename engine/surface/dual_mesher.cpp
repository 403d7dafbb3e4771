#include "surface/dual_mesher.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/parallel.h"

namespace mallow {
namespace {

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
    constexpr Range k_ranges[3] = {{k_block_side - 1, 1, -1}, {0, k_block_side, 0}, {0, 2, k_block_side}};
    for (int bx = 0; bx < 3; ++bx) {
      for (int by = 0; by < 3; ++by) {
        const float* blocks[3];
        for (int bz = 0; bz < 3; ++bz)
          blocks[bz] = distances_of(field, field.neighbors(block)[neighbor_slot(bx - 1, by - 1, bz - 1)]);
        const Range &rx = k_ranges[bx], &ry = k_ranges[by];
        for (int x = 0; x < rx.count; ++x) {
          for (int y = 0; y < ry.count; ++y) {
            const std::size_t row = cell_at(rx.from + x, ry.from + y, 0);
            float* const to = voxel(rx.to + x, ry.to + y, 0);
            to[-1] = blocks[0][row + k_block_side - 1];
            std::memcpy(to, blocks[1] + row, k_block_side * sizeof(float));
            to[k_block_side] = blocks[2][row];
            to[k_block_side + 1] = blocks[2][row + 1];
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

template <class Work>
void for_each_block(const CutCells& cells, const Threads& threads, const Work& work) {
  parallel_for(
      threads, cells.blocks().size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t at = begin; at < end; ++at) work(at);
      },
      k_blocks_at_once);
}

}  // namespace

void DualMesher::place_vertices(const SurfaceField& field, std::size_t at, Mesh& mesh) {
  const BlockCells& cells = cells_.cells(at);
  if (cells.vertices == 0) return;
  const std::uint32_t block = cells_.blocks()[at];
  Padded padded(field, block);
  const Eigen::Vector3d corner = k_block_side * field.blocks().blocks()[block].cast<double>();
  std::size_t next = cells.first_vertex;
  cells_.for_each_cut(at, [&](std::size_t cell, int x, int y, int z) {
    const float* const voxel = padded.voxel(x, y, z);
    const CellPatches& patches = k_cell_patches[cells.patches[cell]];
    for (int patch = 0; patch < patches.count; ++patch, ++next) {
      const Eigen::Vector3f in_cell = middle_of_cuts(patches.edges[static_cast<std::size_t>(patch)], voxel);
      local_[next] = in_cell + Eigen::Vector3i(x, y, z).cast<float>();
      mesh.vertices[first_vertex_ + next] = field.frame().point(corner + local_[next].cast<double>());
      mesh.normals[first_vertex_ + next] = normal_at(voxel, in_cell);
    }
  });
}

void DualMesher::write_triangles(std::size_t at, Mesh& mesh) const {
  auto* to =
      mesh.triangles.data() + first_triangle_ + 2 * static_cast<std::size_t>(cells_.cells(at).first_quad);
  cells_.for_each_quad(at, [&](const std::array<QuadCorner, 4>& quad) {
    const auto place = [&](std::size_t k) -> Eigen::Vector3f {
      return local_[quad[k].vertex] + (k_block_side * quad[k].block).cast<float>();
    };
    // Along the shorter diagonal; ties, as on flat faces, are not left to rounding.
    const std::size_t first =
        (place(1) - place(3)).squaredNorm() < 0.99f * (place(0) - place(2)).squaredNorm() ? 1 : 0;
    const auto vertex = [&](std::size_t k) { return first_vertex_ + quad[(first + k) % 4].vertex; };
    *to++ = {vertex(0), vertex(1), vertex(2)};
    *to++ = {vertex(0), vertex(2), vertex(3)};
  });
}

/// Closes the gaps that merged vertices leave, and writes the triangles between what is left.
void DualMesher::finish_merged(const SurfaceField& field, MeshCounts& counts, Mesh& mesh) {
  std::vector<std::uint32_t> number(cells_.vertices());  // of a vertex that stays, in the mesh
  std::uint32_t kept = 0;
  for (BlockVertices& run : block_vertices_) {
    const Eigen::Vector3d corner = k_block_side * field.blocks().blocks()[run.block].cast<double>();
    const std::uint32_t begin = run.first - first_vertex_, end = begin + run.count;
    run.first = first_vertex_ + kept;
    for (std::uint32_t v = begin; v < end; ++v) {
      if (merger_.into(v) != v) continue;
      local_[kept] = merger_.place(v);
      mesh.vertices[first_vertex_ + kept] = field.frame().point(corner + merger_.place(v).cast<double>());
      mesh.normals[first_vertex_ + kept] = merger_.normal(v);
      number[v] = first_vertex_ + kept++;
    }
    run.count = first_vertex_ + kept - run.first;
  }
  auto* to = mesh.triangles.data() + first_triangle_;
  for (std::size_t at = 0; at < cells_.blocks().size(); ++at) {
    cells_.for_each_quad(at, [&](const std::array<QuadCorner, 4>& quad) {
      const auto vertex = [&](std::size_t corner) { return number[merger_.into(quad[corner].vertex)]; };
      const DividedQuad triangles = merger_.divide(quad);
      for (std::size_t t = 0; t < triangles.count; ++t) {
        const auto& [a, b, c] = triangles.corners[t];
        *to++ = {vertex(a), vertex(b), vertex(c)};
      }
    });
  }
  counts = {first_vertex_ + kept, static_cast<std::size_t>(to - mesh.triangles.data())};
}

void DualMesher::append(const SurfaceField& field, float adaptivity, const Threads& threads,
                        MeshCounts& counts, Mesh& mesh) {
  cells_.find(field, threads);
  first_vertex_ = static_cast<std::uint32_t>(counts.vertices);
  first_triangle_ = counts.triangles;
  counts.vertices += cells_.vertices();
  counts.triangles += 2 * static_cast<std::size_t>(cells_.quads());
  mesh.vertices.resize(counts.vertices);
  mesh.normals.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  local_.resize(cells_.vertices());
  block_vertices_.clear();
  for (std::size_t at = 0; at < cells_.blocks().size(); ++at) {
    const BlockCells& cells = cells_.cells(at);
    if (cells.vertices > 0)
      block_vertices_.push_back({cells_.blocks()[at], first_vertex_ + cells.first_vertex, cells.vertices});
  }
  for_each_block(cells_, threads, [&](std::size_t at) { place_vertices(field, at, mesh); });
  if (adaptivity == 0) {
    for_each_block(cells_, threads, [&](std::size_t at) { write_triangles(at, mesh); });
    return;
  }
  merger_.merge(cells_, adaptivity, threads, local_, std::span(mesh.normals).subspan(first_vertex_));
  finish_merged(field, counts, mesh);
  mesh.vertices.resize(counts.vertices);
  mesh.normals.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
}

std::size_t DualMesher::bytes() const {
  return cells_.bytes() + merger_.bytes() + local_.capacity() * sizeof local_[0] +
         block_vertices_.capacity() * sizeof(BlockVertices);
}

}  // namespace mallow

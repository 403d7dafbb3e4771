#include "surface/dual_mesher.h"

#include <array>
#include <iterator>

#include "core/parallel.h"

namespace mallow {
namespace {

const VertexLanes& best_vertex_lanes() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, vertex_lanes);
}

const QuadLanes& best_quad_lanes() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, quad_lanes);
}

constexpr std::array<float, k_block_voxels> all_voxels(float distance) {
  std::array<float, k_block_voxels> distances{};
  for (float& d : distances) d = distance;
  return distances;
}
constexpr std::array<float, k_block_voxels> k_all_outside = all_voxels(SurfaceField::k_background),
                                            k_all_inside = all_voxels(-SurfaceField::k_background);

const float* distances_of(const SurfaceField& field, std::uint32_t block) {
  if (block == k_no_block) return k_all_outside.data();
  if (field.kind(block) == BlockKind::surface) return field.distances(block);
  return (field.kind(block) == BlockKind::inside ? k_all_inside : k_all_outside).data();
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
  thread_local CellList list;
  cells_.list_vertices(at, list);
  const std::uint32_t block = cells_.blocks()[at];
  VertexBlock from;
  const auto& neighbors = field.neighbors(block);
  for (std::size_t k = 0; k < neighbors.size(); ++k) from.distances[k] = distances_of(field, neighbors[k]);
  from.range = cells.bits.range;
  const VoxelFrame& frame = field.frame();
  const Eigen::Vector3d base = frame.base(), shift = frame.shift();
  for (Eigen::Index a = 0; a < 3; ++a) {
    from.first[a] = shift[a] + k_block_side * field.blocks().blocks()[block][a];
    from.origin[a] = base[a];
  }
  from.voxel_size = frame.voxel_size;
  const std::size_t first = first_vertex_ + std::size_t{cells.first_vertex};
  best_vertex_lanes().place_vertices(
      from, list.vertices,
      {local_[cells.first_vertex].data(), mesh.vertices[first].data(), mesh.normals[first].data()});
}

void DualMesher::write_triangles(std::size_t at, Mesh& mesh) const {
  const BlockCells& cells = cells_.cells(at);
  if (cells.bits.quads == 0) return;
  QuadBlock block = cells_.quad_block(at);
  block.local = local_.data()->data();
  block.first_in_mesh = first_vertex_;
  const std::size_t first = first_triangle_ + 2 * std::size_t{cells.first_quad};
  best_quad_lanes().write_quads(block, mesh.triangles[first].data());
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
  local_.resize(cells_.vertices() + std::size_t{1});  // four floats of the last one are read
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
  merger_.merge(field, cells_, adaptivity, threads, local_, std::span(mesh.normals).subspan(first_vertex_));
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

#pragma once

#include <cstdint>
#include <vector>

#include "core/threads.h"
#include "mallow/mesh.h"
#include "surface/cut_cells.h"
#include "surface/surface_field.h"
#include "surface/vertex_merger.h"

namespace mallow {

/// How much of a mesh is there.
struct MeshCounts {
  std::size_t vertices = 0, triangles = 0;
};

/// Meshes the zero of a level set: a vertex for each patch of surface in a cell, at the mean of where the
/// patch cuts the cell's edges, and two triangles for each quad. Keeps its memory from one frame to the next.
class DualMesher {
 public:
  /// Appends the mesh of a field to what counts so far: vertices [m], normals, triangles. What the mesh holds
  /// beyond that is overwritten: clearing it first would set all of it to zero, for nothing. Vertices are in
  /// the order of the blocks they lie in. adaptivity: see SurfaceConfig.
  void append(const SurfaceField& field, float adaptivity, const Threads& threads, MeshCounts& counts,
              Mesh& mesh);

  /// A run of the vertices appended last, all in or next to one block.
  struct BlockVertices {
    std::uint32_t block;         ///< of the field
    std::uint32_t first, count;  ///< in the mesh
  };
  const std::vector<BlockVertices>& block_vertices() const { return block_vertices_; }
  /// A vertex appended last, in voxels from its block's first voxel.
  const Eigen::Vector3f& local(std::uint32_t vertex) const { return local_[vertex - first_vertex_]; }
  std::size_t bytes() const;

 private:
  void place_vertices(const SurfaceField& field, std::size_t at, Mesh& mesh);
  void write_triangles(std::size_t at, Mesh& mesh) const;
  void finish_merged(const SurfaceField& field, MeshCounts& counts, Mesh& mesh);

  CutCells cells_;
  VertexMerger merger_;
  std::vector<BlockVertices> block_vertices_;
  std::vector<Eigen::Vector3f> local_;
  std::uint32_t first_vertex_ = 0;
  std::size_t first_triangle_ = 0;
};

}  // namespace mallow

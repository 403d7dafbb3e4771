#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "level_set/surface_field.h"
#include "mallow/mesh.h"

namespace mallow {

/// How much of a mesh is there.
struct MeshCounts {
  std::size_t vertices = 0, triangles = 0;
};

/// Meshes the zero of a level set: a vertex for each patch of surface in a cell between eight voxels, at the
/// mean of where the patch cuts the cell's edges, and a quad, as two triangles, for each edge that is cut
/// (dual marching cubes, Nielson 2004; closed and manifold after Wenger 2013, 3.3). The mesh is closed
/// whatever the distances are. Keeps its memory from one frame to the next.
class DualMesher {
 public:
  /// Appends the mesh of a field to what counts so far: vertices [m], normals, triangles. What the mesh holds
  /// beyond that is overwritten: clearing it first would set all of it to zero, for nothing. Vertices are in
  /// the order of the blocks they lie in.
  void append(const SurfaceField& field, int threads, MeshCounts& counts, Mesh& mesh);

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
  /// What the cells of a block hold; a cell has its lowest voxel in the block.
  struct Cells {
    std::array<std::uint8_t, k_block_voxels> inside;    ///< corners, a bit each
    std::array<std::uint16_t, k_block_voxels> patches;  ///< which of k_cell_patches; where the cell is cut
    std::array<std::uint16_t, k_block_voxels> vertex;   ///< first vertex, from the block's first on; likewise
    std::uint32_t first_vertex, vertices, first_quad, quads;
  };
  /// Bit z of row (x, y) is set where the voxel is inside.
  using SignRows = std::array<std::uint8_t, k_block_side * k_block_side>;

  void choose_blocks(const SurfaceField& field);
  const Cells& cells_of(std::size_t at, const Eigen::Vector3i& offset) const;
  void find_signs(const SurfaceField& field, std::size_t at);
  void find_corners(const SurfaceField& field, std::size_t at);
  void count(std::size_t at);
  void place_vertices(const SurfaceField& field, std::size_t at, Mesh& mesh);
  void write_triangles(std::size_t at, Mesh& mesh) const;

  std::vector<std::uint32_t> blocks_;  ///< those with a cell that may be cut
  std::vector<std::uint32_t> place_;   ///< of each block of the field among them
  std::vector<std::array<std::uint32_t, 27>> neighbors_;
  std::vector<SignRows> signs_;
  std::vector<Cells> cells_;
  std::vector<BlockVertices> block_vertices_;
  std::vector<Eigen::Vector3f> local_;
  std::uint32_t first_vertex_ = 0;
  std::size_t first_triangle_ = 0;
};

}  // namespace mallow

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/threads.h"
#include "mallow/vec3.h"
#include "surface/cut_cells.h"

namespace mallow {

/// Triangles of a quad whose corners may have become one vertex: none, one or two, by the quad's corners.
struct DividedQuad {
  std::size_t count = 0;
  std::array<std::array<std::size_t, 3>, 2> corners;
};

/// Makes one vertex of those in cubes of 2³, 4³ and 8³ cells of a block, where the surface in a cube is a
/// single patch and no vertex lies farther than a tolerance from the plane through their mean (Ju et al.
/// 2002, "Dual contouring of Hermite data", 4). The mesh stays closed and manifold: a cube's patch is a disk
/// that crosses each of its faces once at most. Cubes whose triangles would fold over are divided again.
class VertexMerger {
 public:
  /// tolerance: [voxels]. places, normals: of the vertices of the cells, in voxels from their block's first.
  void merge(const SurfaceField& field, const CutCells& cells, float tolerance, const Threads& threads,
             std::span<const Eigen::Vector3f> places, std::span<const Vec3> normals);

  /// The vertex that stands for a vertex's cube, the first of them.
  std::uint32_t into(std::uint32_t vertex) const { return into_[vertex]; }
  /// Mean place and normal of the vertices in a vertex's cube.
  const Eigen::Vector3f& place(std::uint32_t vertex) const { return places_[vertex]; }
  const Vec3& normal(std::uint32_t vertex) const { return normals_[vertex]; }
  /// Along the shorter diagonal, or the one that leaves both triangles facing the way the surface does.
  DividedQuad divide(const std::array<QuadCorner, 4>& quad) const;
  std::size_t bytes() const;

 private:
  /// Sides of the cubes that a block's cells are in: 1, 2, 4 or 8.
  using CubeSides = std::array<std::uint8_t, k_block_voxels>;
  struct CellOfBlock {
    std::uint32_t at;
    std::uint32_t cell;
    std::uint8_t side;  ///< of its cube
  };

  void merge_block(const CutCells& cells, std::size_t at, std::span<const Eigen::Vector3f> places,
                   std::span<const Vec3> normals);
  void find_folds(const CutCells& cells, std::size_t at, std::vector<CellOfBlock>& folds) const;
  void halve(const CutCells& cells, const std::vector<CellOfBlock>& folds);
  Eigen::Vector3f place_of(const QuadCorner& corner) const;
  float facing(const std::array<QuadCorner, 4>& quad, const std::array<std::size_t, 3>& corners) const;

  std::vector<CubeSides> sides_;  ///< of each block
  std::vector<std::vector<CellOfBlock>> folds_;
  std::vector<std::uint32_t> into_;
  std::vector<Eigen::Vector3f> places_;
  std::vector<Vec3> normals_;
};

}  // namespace mallow

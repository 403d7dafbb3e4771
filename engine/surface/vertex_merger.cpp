#include "surface/vertex_merger.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Normals of merged vertices are at most 37 degrees off their mean, so that no triangle turns over.
constexpr float k_least_cosine = 0.8f;

/// What a cube of cells holds.
enum class Content : std::uint8_t {
  nothing,  ///< the surface is elsewhere
  patch,    ///< one patch, a disk, with one vertex
  more
};

/// A cell whose surface is one patch that crosses each face once at most.
bool is_single(unsigned inside) {
  return k_cell_patches[inside].count == 1 && k_cell_patches[inside].twice < 0;
}

/// Calls visit(cell) for the cells of a cube.
template <class Visit>
void for_each_cell(int side, int x, int y, int z, const Visit& visit) {
  for (int i = x; i < x + side; ++i)
    for (int j = y; j < y + side; ++j)
      for (int k = z; k < z + side; ++k) visit(cell_at(i, j, k));
}

class CubeFinder {
 public:
  /// inside: corners of the cells, a bit each.
  CubeFinder(const BlockCells& cells, const std::array<std::uint8_t, k_block_voxels>& inside,
             std::span<const Eigen::Vector3f> places, std::span<const Vec3> normals, float tolerance,
             std::array<std::uint8_t, k_block_voxels>& sides)
      : cells_(cells),
        inside_(inside),
        places_(places),
        normals_(normals),
        tolerance_(tolerance),
        sides_(sides) {}

  /// What the cube at (x, y, z) holds.
  Content find(int side, int x, int y, int z) {
    if (side == 1) {
      const unsigned corners = inside_[cell_at(x, y, z)];
      if (corners == 0 || corners == 255) return Content::nothing;
      return is_single(corners) ? Content::patch : Content::more;
    }
    const int half = side / 2;
    bool mergeable = true, empty = true;
    for (int part = 0; part < 8; ++part) {
      const Content content =
          find(half, x + (part >> 2) * half, y + (part >> 1 & 1) * half, z + (part & 1) * half);
      mergeable = mergeable && content != Content::more;
      empty = empty && content == Content::nothing;
    }
    if (empty) return Content::nothing;
    if (!mergeable || !is_disk(side, x, y, z) || !is_even(side, x, y, z)) return Content::more;
    for_each_cell(side, x, y, z, [&](std::size_t cell) {
      if (cells_.is_cut(cell)) sides_[cell] = static_cast<std::uint8_t>(side);
    });
    return Content::patch;
  }

 private:
  /// Whether a corner of the cells, 0 to 8 along each axis, is inside.
  bool is_inside(int x, int y, int z) const {
    const int cx = std::min(x, k_block_side - 1), cy = std::min(y, k_block_side - 1),
              cz = std::min(z, k_block_side - 1);
    return inside_[cell_at(cx, cy, cz)] >> ((x - cx) * 4 + (y - cy) * 2 + (z - cz)) & 1;
  }

  /// Whether the corners alone tell what the surface in a cube looks like: the middle of each edge, each face
  /// and of the cube is on the side of one of its corners, and the corners make a single patch.
  bool is_disk(int side, int x, int y, int z) const {
    const int half = side / 2;
    bool at[3][3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) at[i][j][k] = is_inside(x + i * half, y + j * half, z + k * half);
    unsigned corners = 0;
    for (int c = 0; c < 8; ++c)
      corners |= static_cast<unsigned>(at[c >> 2 << 1][(c >> 1 & 1) << 1][(c & 1) << 1]) << c;
    if (!is_single(corners)) return false;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < 3; ++k) {
          // The corners of the edge, face or cube that this is the middle of.
          bool agrees = false;
          for (int c = 0; c < 8; ++c) {
            const int ci = i == 1 ? c >> 2 << 1 : i, cj = j == 1 ? (c >> 1 & 1) << 1 : j,
                      ck = k == 1 ? (c & 1) << 1 : k;
            agrees = agrees || at[ci][cj][ck] == at[i][j][k];
          }
          if (!agrees) return false;
        }
      }
    }
    return true;
  }

  /// Whether the vertices in a cube lie in about a plane.
  bool is_even(int side, int x, int y, int z) {
    group_.clear();
    Eigen::Vector3f mean(0, 0, 0);
    Vec3 normal(0, 0, 0);
    for_each_cell(side, x, y, z, [&](std::size_t cell) {
      if (!cells_.is_cut(cell)) return;
      const std::uint16_t v = cells_.vertex[cell];
      group_.push_back(v);
      mean += places_[v];
      normal += normals_[v];
    });
    mean /= static_cast<float>(group_.size());
    if (!(normal.squaredNorm() > 0)) return false;
    normal.normalize();
    return std::all_of(group_.begin(), group_.end(), [&](std::uint16_t v) {
      return std::abs((places_[v] - mean).dot(normal)) <= tolerance_ &&
             normals_[v].dot(normal) >= k_least_cosine;
    });
  }

  const BlockCells& cells_;
  const std::array<std::uint8_t, k_block_voxels>& inside_;
  std::span<const Eigen::Vector3f> places_;
  std::span<const Vec3> normals_;
  float tolerance_;
  std::array<std::uint8_t, k_block_voxels>& sides_;
  std::vector<std::uint16_t> group_;
};

}  // namespace

/// Merges the vertices of a block by its cubes.
void VertexMerger::merge_block(const CutCells& cells, std::size_t at, std::span<const Eigen::Vector3f> places,
                               std::span<const Vec3> normals) {
  const BlockCells& block = cells.cells(at);
  const auto begin = static_cast<std::ptrdiff_t>(block.first_vertex);
  const auto end = begin + static_cast<std::ptrdiff_t>(block.vertices);
  std::iota(into_.begin() + begin, into_.begin() + end, block.first_vertex);
  std::copy(places.begin() + begin, places.begin() + end, places_.begin() + begin);
  std::copy(normals.begin() + begin, normals.begin() + end, normals_.begin() + begin);
  cells.for_each_cut(at, [&](std::size_t first, int x, int y, int z) {
    const int side = sides_[at][first];
    const std::uint32_t target = block.first_vertex + block.vertex[first];
    if (side == 1 || into_[target] != target) return;
    Eigen::Vector3f place(0, 0, 0);
    Vec3 normal(0, 0, 0);
    float count = 0;
    const auto each_vertex = [&](const auto& visit) {
      for_each_cell(side, x / side * side, y / side * side, z / side * side, [&](std::size_t cell) {
        if (block.is_cut(cell)) visit(block.first_vertex + block.vertex[cell]);
      });
    };
    each_vertex([&](std::uint32_t v) {
      place += places[v];
      normal += normals[v];
      ++count;
    });
    each_vertex([&](std::uint32_t v) {
      into_[v] = target;
      places_[v] = place / count;
      normals_[v] = normal.normalized();
    });
  });
}

/// A corner's place, in voxels from the first one of the quad's block.
Eigen::Vector3f VertexMerger::place_of(const QuadCorner& corner) const {
  return places_[corner.vertex] + (k_block_side * corner.block).cast<float>();
}

/// Above 0 where a triangle of a quad's corners faces the way its vertices do.
float VertexMerger::facing(const std::array<QuadCorner, 4>& quad,
                           const std::array<std::size_t, 3>& corners) const {
  const QuadCorner &a = quad[corners[0]], &b = quad[corners[1]], &c = quad[corners[2]];
  const Eigen::Vector3f from = place_of(a);
  return (place_of(b) - from)
      .cross(place_of(c) - from)
      .dot(normals_[a.vertex] + normals_[b.vertex] + normals_[c.vertex]);
}

DividedQuad VertexMerger::divide(const std::array<QuadCorner, 4>& quad) const {
  std::array<std::size_t, 4> left;  // corners, less those that are the same vertex as the one before
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (into_[quad[k].vertex] != into_[quad[(k + 3) % 4].vertex]) left[count++] = k;
  if (count < 3) return {};
  if (count == 3) return {.count = 1, .corners = {{{left[0], left[1], left[2]}}}};
  const DividedQuad along_02{.count = 2, .corners = {{{0, 1, 2}, {0, 2, 3}}}};
  const DividedQuad along_13{.count = 2, .corners = {{{1, 2, 3}, {1, 3, 0}}}};
  const auto faces = [&](const DividedQuad& triangles) {
    return facing(quad, triangles.corners[0]) > 0 && facing(quad, triangles.corners[1]) > 0;
  };
  if (const bool faces_02 = faces(along_02); faces_02 != faces(along_13))
    return faces_02 ? along_02 : along_13;
  return (place_of(quad[1]) - place_of(quad[3])).squaredNorm() <
                 0.99f * (place_of(quad[0]) - place_of(quad[2])).squaredNorm()
             ? along_13
             : along_02;
}

/// Cells of cubes with a triangle that faces backwards.
void VertexMerger::find_folds(const CutCells& cells, std::size_t at, std::vector<CellOfBlock>& folds) const {
  folds.clear();
  cells.for_each_quad(at, [&](const std::array<QuadCorner, 4>& quad) {
    const auto side = [&](const QuadCorner& corner) { return sides_[corner.at][corner.cell]; };
    if (std::all_of(quad.begin(), quad.end(), [&](const QuadCorner& corner) { return side(corner) == 1; }))
      return;
    const DividedQuad triangles = divide(quad);
    for (std::size_t t = 0; t < triangles.count; ++t) {
      if (facing(quad, triangles.corners[t]) > 0) continue;
      for (const std::size_t k : triangles.corners[t])
        if (side(quad[k]) > 1)
          folds.push_back({quad[k].at, static_cast<std::uint32_t>(quad[k].cell), side(quad[k])});
    }
  });
}

/// Divides the cubes with folds. The parts of a cube that can be merged can be merged too.
void VertexMerger::halve(const CutCells& cells, const std::vector<CellOfBlock>& folds) {
  for (const auto& [at, cell, side] : folds) {
    if (sides_[at][cell] != side) continue;  // a fold before this one was in the same cube
    const auto corner = [side = int{side}](std::uint32_t c) { return static_cast<int>(c) / side * side; };
    const BlockCells& block = cells.cells(at);
    for_each_cell(side, corner(cell / (k_block_side * k_block_side)),
                  corner(cell / k_block_side % k_block_side), corner(cell % k_block_side),
                  [&, at = at, side = side](std::size_t c) {
                    if (block.is_cut(c)) sides_[at][c] = side / 2;
                  });
  }
}

void VertexMerger::merge(const SurfaceField& field, const CutCells& cells, float tolerance,
                         const Threads& threads, std::span<const Eigen::Vector3f> places,
                         std::span<const Vec3> normals) {
  const std::size_t blocks = cells.blocks().size();
  sides_.resize(blocks);
  folds_.resize(blocks);
  into_.resize(cells.vertices());
  places_.resize(cells.vertices());
  normals_.resize(cells.vertices());
  const auto each = [&](const auto& work) {
    parallel_for(
        threads, blocks,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t at = begin; at < end; ++at) work(at);
        },
        k_blocks_at_once);
  };
  each([&](std::size_t at) {
    const BlockCells& block = cells.cells(at);
    sides_[at].fill(1);
    if (block.vertices == 0) return;
    std::array<std::uint8_t, k_block_voxels> inside;
    cells.find_corners(field, at, inside);
    CubeFinder(block, inside, places.subspan(block.first_vertex, block.vertices),
               normals.subspan(block.first_vertex, block.vertices), tolerance, sides_[at])
        .find(k_block_side, 0, 0, 0);
  });
  for (;;) {
    each([&](std::size_t at) { merge_block(cells, at, places, normals); });
    each([&](std::size_t at) { find_folds(cells, at, folds_[at]); });
    if (std::all_of(folds_.begin(), folds_.end(), [](const auto& folds) { return folds.empty(); })) return;
    for (const auto& folds : folds_) halve(cells, folds);
  }
}

std::size_t VertexMerger::bytes() const {
  std::size_t bytes = sides_.capacity() * sizeof(CubeSides) + into_.capacity() * sizeof(std::uint32_t) +
                      (places_.capacity() + normals_.capacity()) * sizeof places_[0];
  for (const std::vector<CellOfBlock>& folds : folds_)
    bytes += sizeof(std::vector<CellOfBlock>) + folds.capacity() * sizeof(CellOfBlock);
  return bytes;
}

}  // namespace mallow

#pragma once

#include <cstdint>
#include <vector>

#include "core/threads.h"
#include "mallow/mesh.h"

namespace mallow {

/// Taubin 1995, "A signal processing approach to fair surface design": every round moves vertices towards the
/// middle of their neighbours and then a little farther back, which evens out what is as short as an edge and
/// leaves what is long, and with it the volume. Keeps its memory.
class MeshSmoother {
 public:
  /// Vertices from `first` on, and their normals anew, which triangles from `first_triangle` on have.
  void smooth(int rounds, std::size_t first, std::size_t first_triangle, const Threads& threads, Mesh& mesh);

 private:
  void find_triangles(std::size_t first, std::size_t first_triangle, const Mesh& mesh);

  std::vector<std::uint32_t> begin_, triangles_;  ///< of each vertex
  std::vector<Vec3> next_;
};

}  // namespace mallow

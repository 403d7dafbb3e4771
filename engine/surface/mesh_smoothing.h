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
  /// Vertices from `first` on, and their normals anew; triangles have no others from there on.
  void smooth(int rounds, std::size_t first, const Threads& threads, Mesh& mesh);

 private:
  void find_triangles(std::size_t first, const Mesh& mesh);

  std::vector<std::uint32_t> begin_, triangles_;  ///< of each vertex
  std::vector<Vec3> next_;
};

}  // namespace mallow

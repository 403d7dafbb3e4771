#include "surface/mesh_smoothing.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Shares of the way to the middle of the neighbours, forth and back: they let pass what is longer than about
/// ten edges.
constexpr float k_forth = 0.5f, k_back = -0.5263f;

}  // namespace

void MeshSmoother::find_triangles(std::size_t first, std::size_t first_triangle, const Mesh& mesh) {
  const std::size_t n = mesh.vertices.size() - first;
  begin_.assign(n + 1, 0);
  for (std::size_t t = first_triangle; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) ++begin_[v - first + 1];
  for (std::size_t v = 0; v < n; ++v) begin_[v + 1] += begin_[v];
  triangles_.resize(begin_[n]);
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t t = first_triangle; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      triangles_[next[v - first]++] = static_cast<std::uint32_t>(t);
}

void MeshSmoother::smooth(int rounds, std::size_t first, std::size_t first_triangle, const Threads& threads,
                          Mesh& mesh) {
  find_triangles(first, first_triangle, mesh);
  const std::size_t n = mesh.vertices.size() - first;
  next_.resize(n);
  const auto for_each_vertex = [&](const auto& work) {
    parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) work(v);
    });
  };
  const auto move = [&](float share) {
    for_each_vertex([&](std::size_t v) {
      // Each neighbour is in two triangles.
      const Vec3& x = mesh.vertices[first + v];
      Vec3 sum(0, 0, 0);
      float count = 0;
      for (std::uint32_t k = begin_[v]; k < begin_[v + 1]; ++k) {
        for (const std::uint32_t u : mesh.triangles[triangles_[k]]) sum += mesh.vertices[u] - x;
        count += 2;
      }
      next_[v] = count > 0 ? Vec3(x + share / count * sum) : x;
    });
    std::copy(next_.begin(), next_.end(), mesh.vertices.begin() + static_cast<std::ptrdiff_t>(first));
  };
  for (int round = 0; round < rounds; ++round) {
    move(k_forth);
    move(k_back);
  }
  for_each_vertex([&](std::size_t v) {
    Vec3 sum(0, 0, 0);
    for (std::uint32_t k = begin_[v]; k < begin_[v + 1]; ++k) {
      const auto& t = mesh.triangles[triangles_[k]];
      const Vec3& a = mesh.vertices[t[0]];
      sum += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    }
    if (sum.squaredNorm() > 0) mesh.normals[first + v] = sum.normalized();
  });
}

}  // namespace mallow

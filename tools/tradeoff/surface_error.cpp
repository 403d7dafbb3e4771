#include "tradeoff/surface_error.h"

#include <cmath>
#include <limits>

#include "surface/nearest_points.h"

namespace mallow::tradeoff {
namespace {

/// The face at a vertex says how far a point is from a surface only near by; farther off, the vertex does.
constexpr float k_near = 1;  // [spacings]

/// Sum of the squared distances of the vertices of a mesh from another.
double squares(const Mesh& from, const Mesh& to, float spacing, int threads) {
  const bool have_normals =
      from.normals.size() == from.vertices.size() && to.normals.size() == to.vertices.size();
  const auto nearest = find_nearest(from.vertices, to.vertices, 0.5f * spacing, threads);
  double sum = 0;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const auto& [distance, index] = nearest[i];
    // Between two points of one sphere, along the mean of their normals, there is nothing.
    const Vec3 along = have_normals ? Vec3(from.normals[i] + to.normals[index]) : Vec3(0, 0, 0);
    const bool to_face = along.norm() > 1 && distance < k_near * spacing;
    const double d = static_cast<double>(
        to_face ? along.normalized().dot(from.vertices[i] - to.vertices[index]) : distance);
    sum += d * d;
  }
  return sum;
}

}  // namespace

double surface_error(const Mesh& mesh, const Mesh& fine, float spacing, int threads) {
  if (mesh.vertices.empty() && fine.vertices.empty()) return 0;
  if (mesh.vertices.empty() || fine.vertices.empty()) return std::numeric_limits<double>::infinity();
  const double sum = squares(mesh, fine, spacing, threads) + squares(fine, mesh, spacing, threads);
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size() + fine.vertices.size())) /
         static_cast<double>(spacing);
}

}  // namespace mallow::tradeoff

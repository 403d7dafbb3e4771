#include "surface/skin_binding.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <sstream>

#include "core/checks.h"
#include "core/parallel.h"
#include "surface/particle_cells.h"
#include "surface/surface_checks.h"

namespace mallow {
namespace {

/// Farthest that a particle carries a vertex [spacings]: a mesh that is farther out is not the body's.
constexpr float k_reach = 3;
/// Square of the kernel's radius, by that of the distance to the nearest particle that does not carry the
/// vertex: where the nearest nine are equally far, eight of them share the vertex.
constexpr float k_beyond = 1.01f;

struct NearVertex {
  float square;  ///< of the distance, in reaches
  std::uint32_t particle;
  auto operator<=>(const NearVertex&) const = default;
};

/// near: in any order; at least one.
VertexBinding binding_of(std::vector<NearVertex>& near) {
  const std::size_t count = std::min(near.size(), k_skin_particles + 1);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  const float radius = std::min(1.0f, near.size() > k_skin_particles ? near[k_skin_particles].square : 1.0f);
  VertexBinding binding{};
  double sum = 0;
  std::array<double, k_skin_particles> weights{};
  for (std::size_t k = 0; k < std::min(count, k_skin_particles); ++k) {
    binding.particle[k] = near[k].particle;
    const double t = 1 - static_cast<double>(near[k].square) / static_cast<double>(k_beyond * radius);
    sum += weights[k] = t * t * t;
  }
  for (std::size_t k = 0; k < k_skin_particles; ++k) {
    binding.weight[k] = static_cast<float>(weights[k] / sum);
    if (k >= count) binding.particle[k] = binding.particle[0];
  }
  return binding;
}

[[noreturn]] void refuse_far(std::span<const Vec3> vertices, std::span<const std::uint8_t> far,
                             float spacing) {
  const auto first = static_cast<std::size_t>(std::ranges::find(far, 1) - far.begin());
  std::ostringstream text;
  text << '(' << vertices[first].transpose() << ") is not allowed: a place within " << k_reach
       << " spacings of the body, that is " << k_reach * spacing << " m";
  if (const auto more = std::ranges::count(far, 1) - 1; more > 0) text << "; so are " << more << " others";
  throw ConfigError(element("mesh.vertices", first), text.str());
}

}  // namespace

void check_skin(const Mesh& mesh) {
  Checks checks;
  const std::size_t n = mesh.vertices.size();
  if (n == 0) checks.problem("mesh.vertices", "there is none: at least one is needed");
  check_finite("mesh.vertices", mesh.vertices, checks);
  if (!mesh.normals.empty() && mesh.normals.size() != n)
    checks.problem("mesh.normals", std::to_string(mesh.normals.size()) +
                                       " are not allowed: none, or one for " + "each of " +
                                       std::to_string(n) + " vertices");
  check_finite("mesh.normals", mesh.normals, checks);
  const auto none = std::ranges::find_if(mesh.normals, [](const Vec3& v) { return !(v.norm() > 0); });
  if (none != mesh.normals.end())
    checks.problem(element("mesh.normals", static_cast<std::size_t>(none - mesh.normals.begin())),
                   "has no length");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const std::uint32_t last = *std::max_element(corners.begin(), corners.end());
    if (last < n) continue;
    checks.problem(element("mesh.triangles", t),
                   "there is no vertex " + std::to_string(last) + "; there are " + std::to_string(n));
    break;
  }
  checks.finish();
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  const std::vector<Vec3>& x = mesh.vertices;
  std::vector<Eigen::Vector3d> sums(x.size(), Eigen::Vector3d::Zero());
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = x[t[0]].cast<double>();
    const Eigen::Vector3d area = (x[t[1]].cast<double>() - a).cross(x[t[2]].cast<double>() - a);
    for (const std::uint32_t v : t) sums[v] += area;
  }
  // Files give the two sides of a texture's seam vertices of their own, at one place.
  std::vector<std::uint32_t> order(x.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) { return std::array{x[v].x(), x[v].y(), x[v].z()}; };
  std::ranges::stable_sort(order, {}, key);
  std::vector<Vec3> normals(x.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (; end < order.size() && key(order[end]) == key(order[begin]); ++end) sum += sums[order[end]];
    const bool known = sum.norm() > 0;
    const Vec3 normal = known ? Vec3(sum.normalized().cast<float>()) : Vec3(0, 0, 1);
    for (std::size_t k = begin; k < end; ++k) normals[order[k]] = normal;
  }
  return normals;
}

Column<VertexBinding> bind_vertices(std::span<const Vec3> vertices, const PickedVectors& particles,
                                    float spacing, const Threads& threads) {
  ParticleCells cells;
  cells.sort(particles, spacing, k_reach * spacing, threads);
  Column<VertexBinding> bindings;
  bindings.resize(vertices.size());
  std::vector<std::uint8_t> far(vertices.size(), 0);
  parallel_for(threads, vertices.size(), [&](std::size_t begin, std::size_t end) {
    thread_local NearParticles near;
    thread_local std::vector<NearVertex> list;
    for (std::size_t v = begin; v < end; ++v) {
      cells.find_near(vertices[v].cast<double>(), 0, near);
      list.clear();
      for (std::size_t k = 0; k < near.count; ++k) {
        const float square = near.x[k] * near.x[k] + near.y[k] * near.y[k] + near.z[k] * near.z[k];
        if (square < 1) list.push_back({square, cells.particle(near.places[k])});
      }
      far[v] = list.empty() ? 1 : 0;
      if (!list.empty()) bindings[v] = binding_of(list);
    }
  });
  if (std::ranges::find(far, 1) != far.end()) refuse_far(vertices, far, spacing);
  return bindings;
}

}  // namespace mallow

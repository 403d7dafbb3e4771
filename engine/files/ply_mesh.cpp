#include <cmath>

#include "files/mesh_readers.h"
#include "files/ply.h"
#include "files/read_origin.h"

namespace mallow {
namespace {

/// How far the squared length of a normal may be from 1 after rounding to text or float.
constexpr float k_unit_tolerance = 1e-3f;

void read_vertices(PlyReader& ply, const PlyElement& element, Eigen::Vector3d* origin, Mesh& mesh) {
  ReadOrigin near(origin);
  const auto position = ply.find_vector(element, {"x", "y", "z"}, true);
  const auto normal = ply.find_vector(element, {"nx", "ny", "nz"}, false);
  const auto velocity = ply.find_vector(element, {"vx", "vy", "vz"}, false);
  const auto material = ply.find_scalar(element, "material_id");
  mesh.vertices.reserve(element.count);
  while (ply.next_row()) {
    mesh.vertices.push_back(near.relative(ply.finite_point(*position)));
    if (normal) mesh.normals.push_back(ply.finite_vector(*normal));
    if (velocity) mesh.velocities.push_back(ply.finite_vector(*velocity));
    if (material) mesh.material_ids.push_back(ply.index(ply.value(*material), k_most_bodies, "material_id"));
  }
  // Other programs leave normals zero or unscaled; then the mesh is better off without.
  for (const Vec3& n : mesh.normals) {
    if (std::abs(n.squaredNorm() - 1.0f) <= k_unit_tolerance) continue;
    mesh.normals.clear();
    break;
  }
}

void read_faces(PlyReader& ply, const PlyElement& element, std::uint64_t vertex_count, Mesh& mesh) {
  auto corners = element.find("vertex_indices");
  if (!corners) corners = element.find("vertex_index");
  if (!corners || !element.properties[*corners].length_type) {
    ply.fail("element 'face' needs a list property 'vertex_indices' or 'vertex_index'");
  }
  ply.keep_list(*corners);
  mesh.triangles.reserve(element.count);
  while (ply.next_row()) {
    const std::span<const double> polygon = ply.list();
    const auto vertex = [&](std::size_t k) { return ply.index(polygon[k], vertex_count, "vertex index"); };
    if (polygon.size() < 3) {
      ply.fail_row(element.properties[*corners].name,
                   counted(polygon.size(), "corner") + " are not allowed: at least 3");
    }
    const std::uint32_t first = vertex(0);
    std::uint32_t second = vertex(1);
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const std::uint32_t third = vertex(k);
      if (mesh.triangles.size() == k_max_rows) ply.fail(why_too_many(k_max_rows + 1, "triangles"));
      mesh.triangles.push_back({first, second, third});
      second = third;
    }
  }
}

}  // namespace

Mesh read_ply_mesh(const std::filesystem::path& file, Eigen::Vector3d* origin) {
  PlyReader ply(file);
  const std::uint64_t vertex_count = ply.require("vertex").count;
  ply.require("face");
  Mesh mesh;
  while (const PlyElement* element = ply.next_element()) {
    if (element->name == "vertex") read_vertices(ply, *element, origin, mesh);
    if (element->name == "face") read_faces(ply, *element, vertex_count, mesh);
  }
  return mesh;
}

}  // namespace mallow

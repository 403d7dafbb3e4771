#include <string>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_readers.h"
#include "files/ply.h"
#include "files/text_reader.h"
#include "files/valid_columns.h"
#include "mallow/files.h"

namespace mallow {
namespace {

std::string ply_header(const Mesh& mesh, std::size_t bytes_of_id) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment mallow mesh\nelement vertex " +
                       std::to_string(mesh.vertices.size()) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!mesh.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.velocities.empty()) header += "property float vx\nproperty float vy\nproperty float vz\n";
  if (!mesh.material_ids.empty())
    header += std::string("property ") + ply_body_type(bytes_of_id) + " material_id\n";
  return header + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar uint vertex_indices\nend_header\n";
}

Mesh read(const std::filesystem::path& file, Eigen::Vector3d* origin) {
  const std::string ending = lower_case_ending(file);
  if (ending == ".obj") return read_obj(file, origin);
  if (ending == ".ply") return read_ply_mesh(file, origin);
  if (ending == ".stl") return read_stl(file, origin);
  if (ending == ".off") return read_off(file, origin);
  fail_file(file, "ending " + in_quotes(ending) + " is not allowed for a mesh: .obj, .ply, .stl or .off");
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file) {
  return read(file, nullptr);
}

Mesh read_mesh(const std::filesystem::path& file, Eigen::Vector3d& origin) {
  return read(file, &origin);
}

void write_mesh_ply(const std::filesystem::path& file, const Mesh& mesh) {
  require_valid(mesh);
  const std::size_t bytes_of_id = body_bytes(mesh.material_ids);
  std::string bytes = ply_header(mesh, bytes_of_id);
  const std::size_t vertex_bytes = 12u + (mesh.normals.empty() ? 0u : 12u) +
                                   (mesh.velocities.empty() ? 0u : 12u) +
                                   (mesh.material_ids.empty() ? 0 : bytes_of_id);
  constexpr std::size_t k_triangle_bytes = 13;
  const std::size_t total =
      bytes.size() + mesh.vertices.size() * vertex_bytes + mesh.triangles.size() * k_triangle_bytes;
  require_readable_size(file, total);
  bytes.reserve(total);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    append_little_endian(bytes, mesh.vertices[v]);
    if (!mesh.normals.empty()) append_little_endian(bytes, mesh.normals[v]);
    if (!mesh.velocities.empty()) append_little_endian(bytes, mesh.velocities[v]);
    if (!mesh.material_ids.empty()) append_body(bytes, mesh.material_ids[v], bytes_of_id);
  }
  for (const auto& triangle : mesh.triangles) {
    append_little_endian(bytes, std::uint8_t{3});
    for (const std::uint32_t vertex : triangle) append_little_endian(bytes, vertex);
  }
  write_whole(file, bytes);
}

}  // namespace mallow

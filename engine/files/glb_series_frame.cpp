#include "files/glb_series_frame.h"

#include <algorithm>
#include <cmath>

#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/mesh_part.h"
#include "files/meshopt.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

/// A grid: whole numbers from 0 to k_most along each axis.
struct Grid {
  std::array<std::int64_t, 3> first;
  double scale;
};

Grid grid_around(const Aabb& box) {
  constexpr double k_most = 16383;
  const Eigen::Array3d low = box.min.cast<double>().array(), high = box.max.cast<double>().array();
  const double largest = std::max((high - low).maxCoeff(), 1e-30);
  for (int exponent = std::ilogb(largest / k_most);; ++exponent) {
    const double scale = std::ldexp(1.0, exponent);
    const Eigen::Array3d first = (low / scale).floor();
    if (((high / scale).ceil() - first).maxCoeff() > k_most) continue;
    if (!(first.abs().maxCoeff() < 9e15))
      throw ConfigError("mesh.vertices", "lie too far from 0 for their size to be told apart");
    return {{static_cast<std::int64_t>(first[0]), static_cast<std::int64_t>(first[1]),
             static_cast<std::int64_t>(first[2])},
            scale};
  }
}

/// Appends the place as three numbers of 16 bits and two bytes of nothing, and grows the part's bounds.
void append_place(const Vec3& place, const Grid& grid, std::string& bytes, PackedPart& part) {
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const auto number =
        static_cast<std::int16_t>(std::llround(double{place[k]} / grid.scale) - grid.first[axis]);
    part.min[axis] = std::min<int>(part.min[axis], number);
    part.max[axis] = std::max<int>(part.max[axis], number);
    append_little_endian(bytes, number);
  }
  append_little_endian(bytes, std::int16_t{0});
}

std::string normal_bytes(const std::vector<Vec3>& normals) {
  std::string bytes;
  bytes.reserve(4 * normals.size());
  for (const Vec3& normal : normals) {
    for (const float x : normal)
      append_little_endian(bytes, static_cast<std::int8_t>(std::lround(127 * std::clamp(x, -1.0f, 1.0f))));
    bytes += '\0';
  }
  return bytes;
}

std::string corner_bytes(const std::vector<std::uint32_t>& corners, std::size_t bytes_each) {
  std::string bytes;
  bytes.reserve(bytes_each * corners.size());
  for (const std::uint32_t corner : corners) {
    if (bytes_each == 2)
      append_little_endian(bytes, static_cast<std::uint16_t>(corner));
    else
      append_little_endian(bytes, corner);
  }
  return bytes;
}

}  // namespace

PackedFrame pack_frame(const Mesh& mesh, bool compress) {
  const Grid grid = grid_around(bounds(mesh));
  PackedFrame frame;
  frame.scale = grid.scale;
  for (std::size_t k = 0; k < 3; ++k) frame.origin[k] = static_cast<double>(grid.first[k]) * grid.scale;
  std::vector<std::uint32_t> corners;
  std::vector<Vec3> normals;
  std::size_t most_vertices = 0;
  for (const auto& [body, triangles] : triangles_by_material(mesh)) {
    MeshPart rows = part_of(mesh, triangles);
    if (compress) {
      std::vector<std::uint32_t> order = order_for_meshopt(rows.corners, rows.vertices.size());
      for (std::uint32_t& row : order) row = rows.vertices[row];
      rows.vertices = std::move(order);
    }
    constexpr int k_far = 1 << 20;
    PackedPart part{body,
                    frame.vertices,
                    rows.vertices.size(),
                    corners.size(),
                    rows.corners.size(),
                    {k_far, k_far, k_far},
                    {-k_far, -k_far, -k_far}};
    for (const std::uint32_t row : rows.vertices)
      append_place(mesh.vertices[row], grid, frame.position_bytes, part);
    const std::vector<Vec3> part_normals = picked(mesh.normals, rows.vertices);
    normals.insert(normals.end(), part_normals.begin(), part_normals.end());
    corners.insert(corners.end(), rows.corners.begin(), rows.corners.end());
    frame.vertices += part.vertices;
    most_vertices = std::max(most_vertices, part.vertices);
    frame.parts.push_back(part);
  }
  frame.corners = corners.size();
  // The last number of 16 bits ends a strip where programs make strips of triangles: no vertex has it.
  frame.corner_bytes = most_vertices <= 65535 ? 2 : 4;
  if (compress) {
    frame.position_bytes = meshopt_attributes(frame.position_bytes, 8);
    if (!normals.empty()) frame.normal_bytes = meshopt_attributes(meshopt_octahedral(normals), 4);
    frame.corner_numbers = meshopt_triangles(corners, most_vertices);
  } else {
    frame.normal_bytes = normal_bytes(normals);
    frame.corner_numbers = corner_bytes(corners, frame.corner_bytes);
  }
  return frame;
}

}  // namespace mallow

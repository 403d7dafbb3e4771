#include "files/meshopt.h"

#ifdef MALLOW_MESHOPTIMIZER
#include <meshoptimizer.h>

#include <array>
#include <limits>
#endif

namespace mallow {

#ifdef MALLOW_MESHOPTIMIZER

bool has_meshopt() {
  return true;
}

std::vector<std::uint32_t> order_for_meshopt(std::vector<std::uint32_t>& corners, std::size_t vertices) {
  meshopt_optimizeVertexCacheStrip(corners.data(), corners.data(), corners.size(), vertices);
  std::vector<std::uint32_t> place(vertices);
  const std::size_t used =
      meshopt_optimizeVertexFetchRemap(place.data(), corners.data(), corners.size(), vertices);
  meshopt_remapIndexBuffer(corners.data(), corners.data(), corners.size(), place.data());
  std::vector<std::uint32_t> order(used);
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (place[v] != std::numeric_limits<std::uint32_t>::max()) order[place[v]] = v;
  return order;
}

std::string meshopt_octahedral(const std::vector<Vec3>& normals) {
  constexpr int k_bits = 8;  // of each of two numbers: at most 0.9 degrees from the normal
  std::vector<std::array<float, 4>> padded;
  padded.reserve(normals.size());
  for (const Vec3& normal : normals) padded.push_back({normal.x(), normal.y(), normal.z(), 0});
  std::string bytes(4 * normals.size(), '\0');
  if (!normals.empty()) meshopt_encodeFilterOct(bytes.data(), normals.size(), 4, k_bits, padded[0].data());
  return bytes;
}

std::string meshopt_attributes(std::string_view vertices, std::size_t stride) {
  // The extension's versions; later libraries write newer ones where nothing is said.
  meshopt_encodeVertexVersion(0);
  const std::size_t count = vertices.size() / stride;
  std::string bytes(meshopt_encodeVertexBufferBound(count, stride), '\0');
  bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                          vertices.data(), count, stride));
  return bytes;
}

std::string meshopt_triangles(const std::vector<std::uint32_t>& corners, std::size_t vertices) {
  meshopt_encodeIndexVersion(1);
  std::string bytes(meshopt_encodeIndexBufferBound(corners.size(), vertices), '\0');
  bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                         corners.data(), corners.size()));
  return bytes;
}

#else

bool has_meshopt() {
  return false;
}
std::vector<std::uint32_t> order_for_meshopt(std::vector<std::uint32_t>&, std::size_t) {
  return {};
}
std::string meshopt_octahedral(const std::vector<Vec3>&) {
  return {};
}
std::string meshopt_attributes(std::string_view, std::size_t) {
  return {};
}
std::string meshopt_triangles(const std::vector<std::uint32_t>&, std::size_t) {
  return {};
}

#endif

}  // namespace mallow

#include "mallow/frame_surface.h"

#include <cstdint>
#include <vector>

#include "mallow/level_set.h"

namespace mallow::cli {
namespace {

void append(const Mesh& part, std::uint8_t group, Mesh& whole) {
  const auto first = static_cast<std::uint32_t>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
  whole.material_ids.insert(whole.material_ids.end(), part.vertices.size(), group);
  for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({a + first, b + first, c + first});
}

}  // namespace

Mesh frame_surface(const ParticleFrame& frame, std::span<const float> spacings, const SurfaceConfig& config,
                   int threads) {
  std::vector<std::vector<Vec3>> positions(spacings.size());
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    positions.at(frame.groups[i]).push_back(frame.positions[i]);
  }
  Mesh whole;
  for (std::size_t group = 0; group < spacings.size(); ++group) {
    append(surface(positions[group], spacings[group], config, threads), static_cast<std::uint8_t>(group),
           whole);
  }
  return whole;
}

}  // namespace mallow::cli

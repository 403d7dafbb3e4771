#include "program/frame_surface.h"

#include <algorithm>
#include <limits>
#include <string>

#include "mallow/errors.h"

namespace mallow::program {
namespace {

template <class T>
void append(const std::vector<T>& part, std::vector<T>& list) {
  list.insert(list.end(), part.begin(), part.end());
}

void follow(const Simulation& simulation, Skin& skin) try {
  skin.update(simulation);
} catch (const ConfigError& error) {
  const bool is_there = std::ranges::count(simulation.bodies(), skin.body()) > 0;
  throw ConfigError(is_there ? "skin of " + simulation.name(skin.body()) : "skin",
                    std::string("cannot follow its body any more (") + error.what() +
                        "); keep it from what takes its particles away");
}

}  // namespace

FrameSurface::FrameSurface(const SurfaceConfig& config, std::span<Skin> skins, int threads)
    : surfacer_(config, threads), skins_(skins) {}

Mesh FrameSurface::draw(const Simulation& simulation) {
  Mesh mesh;
  draw(simulation, mesh);
  return mesh;
}

void FrameSurface::draw(const Simulation& simulation, Mesh& mesh) {
  SurfaceParticles particles = surface_particles(simulation);
  std::erase_if(particles.bodies, [&](const SurfaceBody& body) {
    return std::ranges::any_of(skins_, [&](const Skin& skin) { return skin.body() == BodyId{body.body}; });
  });
  if (particles.bodies.empty()) {
    mesh.vertices.clear();
    mesh.triangles.clear();
    mesh.normals.clear();
    mesh.velocities.clear();
    mesh.material_ids.clear();
  } else {
    mesh = surfacer_.draw(particles);
  }
  for (Skin& skin : skins_) {
    follow(simulation, skin);
    append(skin.find_velocities(simulation), mesh);
  }
}

double enclosed_volume(const Mesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto corner = [&](std::uint32_t v) -> Eigen::Vector3d {
      return (mesh.vertices[v] - mesh.vertices[0]).cast<double>();  // near 0, where no digits are lost
    };
    volume += corner(a).dot(corner(b).cross(corner(c))) / 6;
  }
  return volume;
}

void append(const Mesh& part, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  append(part.vertices, mesh.vertices);
  append(part.normals, mesh.normals);
  append(part.velocities, mesh.velocities);
  append(part.material_ids, mesh.material_ids);
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

Mesh part_of(const Mesh& mesh, const std::vector<bool>& chosen) {
  constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();
  Mesh part;
  std::vector<std::uint32_t> number(mesh.vertices.size(), k_none);
  for (std::size_t v = 0; v < number.size(); ++v) {
    const std::uint32_t body = mesh.material_ids.empty() ? 0 : mesh.material_ids[v];
    if (body >= chosen.size() || !chosen[body]) continue;
    number[v] = static_cast<std::uint32_t>(part.vertices.size());
    part.vertices.push_back(mesh.vertices[v]);
    if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[v]);
    if (!mesh.velocities.empty()) part.velocities.push_back(mesh.velocities[v]);
    part.material_ids.push_back(body);
  }
  for (const auto& [a, b, c] : mesh.triangles)
    if (number[a] != k_none && number[b] != k_none && number[c] != k_none)
      part.triangles.push_back({number[a], number[b], number[c]});
  return part;
}

}  // namespace mallow::program

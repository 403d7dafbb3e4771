#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mallow/files.h"

namespace mallow {

/// The material id of a triangle, where a format gives a triangle one: that of most of its corners, the
/// smallest of three that differ, as they may where surfaces are joined.
std::uint32_t triangle_material(const Mesh& mesh, std::size_t triangle);

/// Triangles of each material id that has any, ascending.
std::map<std::uint32_t, std::vector<std::size_t>> triangles_by_material(const Mesh& mesh);

/// Throws ConfigError unless names are UTF-8, colours in [0, 1], and there is a body for each triangle's
/// material.
void require_bodies(const Mesh& mesh, std::span<const MeshBody> bodies);
void require_bodies(std::span<const MeshBody> bodies);

struct NamedMaterial {
  std::string name;   ///< as the format allows it
  std::string title;  ///< as the scene has it
  Appearance appearance;
};

/// Bodies of a mesh under names that a format allows and that differ from each other.
struct NamedBodies {
  std::vector<std::string> names;        ///< of each body, as the format allows it
  std::vector<std::string> titles;       ///< of each body, as the scene has it
  std::vector<NamedMaterial> materials;  ///< each once
  std::vector<std::size_t> material_of;  ///< of each body
};

/// allowed: makes a name one that the format allows, and is not empty; a number goes behind those that are
/// the same then.
using NameRule = std::function<std::string(const std::string& name)>;
NamedBodies name_bodies(std::span<const MeshBody> bodies, const NameRule& allowed);

/// Roughness in [0, 1] of a dielectric that looks like the finish: files know no translucency; jelly is told
/// from clay by what it mirrors.
double roughness(Finish finish);

}  // namespace mallow

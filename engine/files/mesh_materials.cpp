#include "files/mesh_materials.h"

#include <algorithm>
#include <string_view>
#include <tuple>

#include "mallow/errors.h"

namespace mallow {
namespace {

/// The bytes that a character of UTF-8 takes at the start of the text; 0 where there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  // Longer than it has to be, a half of a pair of UTF-16, or beyond the last character.
  const unsigned char second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
    return 0;
  return length;
}

void require_utf8(const std::string& field, std::string_view name) {
  while (!name.empty()) {
    const std::size_t length = utf8_length(name);
    if (length == 0) throw ConfigError(field, "is not allowed: text in UTF-8");
    name.remove_prefix(length);
  }
}

/// Adds the name, with a number behind it where it is there already.
/// names: with the first number that was not yet tried behind each, so that many bodies of one name take no
/// square of their count.
std::string add_distinct(std::map<std::string, int>& names, const std::string& name) {
  const auto [known, added] = names.try_emplace(name, 1);
  std::string distinct = name;
  for (bool is_new = added; !is_new; is_new = names.try_emplace(distinct, 1).second)
    distinct = name + '_' + std::to_string(known->second++);
  return distinct;
}

/// What tells one material from another.
using MaterialKey = std::tuple<std::string, float, float, float, Finish>;
MaterialKey key_of(const std::string& title, const Appearance& appearance) {
  const Vec3& color = appearance.color;
  return {title, color.x(), color.y(), color.z(), appearance.finish};
}

}  // namespace

std::uint32_t triangle_material(const Mesh& mesh, std::size_t triangle) {
  if (mesh.material_ids.empty()) return 0;
  const auto& corners = mesh.triangles[triangle];
  const std::uint32_t a = mesh.material_ids[corners[0]], b = mesh.material_ids[corners[1]],
                      c = mesh.material_ids[corners[2]];
  if (a == b || a == c) return a;
  return b == c ? b : std::min({a, b, c});
}

std::map<std::uint32_t, std::vector<std::size_t>> triangles_by_material(const Mesh& mesh) {
  std::map<std::uint32_t, std::vector<std::size_t>> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) triangles[triangle_material(mesh, t)].push_back(t);
  return triangles;
}

void require_bodies(std::span<const MeshBody> bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string field = "bodies[" + std::to_string(b) + "].";
    require_utf8(field + "name", bodies[b].name);
    require_utf8(field + "material", bodies[b].material);
    const auto color = bodies[b].appearance.color.array();
    if ((color >= 0).all() && (color <= 1).all()) continue;
    throw ConfigError(field + "appearance.color", "is not allowed: linear RGB in [0, 1]");
  }
}

void require_bodies(const Mesh& mesh, std::span<const MeshBody> bodies) {
  require_bodies(bodies);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t id = triangle_material(mesh, t);
    if (id < bodies.size()) continue;
    throw ConfigError("bodies", std::to_string(bodies.size()) + " are not allowed: material id " +
                                    std::to_string(id) + " needs one too");
  }
}

NamedBodies name_bodies(std::span<const MeshBody> bodies, const NameRule& allowed) {
  NamedBodies named;
  std::map<std::string, int> body_names, material_names;
  std::map<MaterialKey, std::size_t> materials;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    named.titles.push_back(bodies[b].name.empty() ? "group " + std::to_string(b) : bodies[b].name);
    named.names.push_back(add_distinct(body_names, allowed(named.titles.back())));
    const std::string title =
        bodies[b].material.empty() ? "material " + std::to_string(b) : bodies[b].material;
    const auto [known, added] =
        materials.try_emplace(key_of(title, bodies[b].appearance), named.materials.size());
    named.material_of.push_back(known->second);
    if (!added) continue;
    named.materials.push_back({add_distinct(material_names, allowed(title)), title, bodies[b].appearance});
  }
  return named;
}

double roughness(Finish finish) {
  switch (finish) {
    case Finish::clay:
      return 0.9;
    case Finish::cream:
      return 0.6;
    case Finish::gloss:
      return 0.2;
    case Finish::syrup:
      return 0.1;
    case Finish::jelly:
      break;
  }
  return 0.5;
}

}  // namespace mallow

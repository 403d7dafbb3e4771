#include "files/mesh_materials.h"

#include <algorithm>
#include <set>
#include <string_view>

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
std::string add_distinct(std::set<std::string>& names, const std::string& name) {
  std::string distinct = name;
  for (int k = 1; !names.insert(distinct).second; ++k) distinct = name + '_' + std::to_string(k);
  return distinct;
}

bool look_the_same(const Appearance& a, const Appearance& b) {
  return a.color == b.color && a.finish == b.finish;
}

}  // namespace

std::uint8_t triangle_material(const Mesh& mesh, std::size_t triangle) {
  if (mesh.material_ids.empty()) return 0;
  const auto& corners = mesh.triangles[triangle];
  const std::uint8_t a = mesh.material_ids[corners[0]], b = mesh.material_ids[corners[1]],
                     c = mesh.material_ids[corners[2]];
  if (a == b || a == c) return a;
  return b == c ? b : std::min({a, b, c});
}

std::map<std::uint8_t, std::vector<std::size_t>> triangles_by_material(const Mesh& mesh) {
  std::map<std::uint8_t, std::vector<std::size_t>> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) triangles[triangle_material(mesh, t)].push_back(t);
  return triangles;
}

void require_groups(std::span<const MeshGroup> groups) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::string field = "groups[" + std::to_string(g) + "].";
    require_utf8(field + "name", groups[g].name);
    require_utf8(field + "material", groups[g].material);
    const auto color = groups[g].appearance.color.array();
    if ((color >= 0).all() && (color <= 1).all()) continue;
    throw ConfigError(field + "appearance.color", "is not allowed: linear RGB in [0, 1]");
  }
}

void require_groups(const Mesh& mesh, std::span<const MeshGroup> groups) {
  require_groups(groups);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint8_t id = triangle_material(mesh, t);
    if (id < groups.size()) continue;
    throw ConfigError("groups", std::to_string(groups.size()) + " are not allowed: material id " +
                                    std::to_string(id) + " needs one too");
  }
}

NamedGroups name_groups(std::span<const MeshGroup> groups, const NameRule& allowed) {
  NamedGroups named;
  std::set<std::string> group_names;
  std::set<std::string> material_names;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    named.titles.push_back(groups[g].name.empty() ? "group " + std::to_string(g) : groups[g].name);
    named.names.push_back(add_distinct(group_names, allowed(named.titles.back())));
    const std::string title =
        groups[g].material.empty() ? "material " + std::to_string(g) : groups[g].material;
    const auto known =
        std::find_if(named.materials.begin(), named.materials.end(), [&](const NamedMaterial& other) {
          return other.title == title && look_the_same(other.appearance, groups[g].appearance);
        });
    named.material_of.push_back(static_cast<std::size_t>(known - named.materials.begin()));
    if (known != named.materials.end()) continue;
    named.materials.push_back({add_distinct(material_names, allowed(title)), title, groups[g].appearance});
  }
  return named;
}

double roughness(Finish finish) {
  return finish == Finish::clay ? 0.9 : 0.5;
}

}  // namespace mallow

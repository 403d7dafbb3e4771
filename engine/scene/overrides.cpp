#include "scene/overrides.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "files/nearest_name.h"
#include "mallow/materials.h"
#include "scene/field_reader.h"
#include "scene/scene_fields.h"

namespace mallow::scene_file {
namespace {

/// A step into a table (by key), a list of named tables (by name) or a list (by number).
struct Segment {
  std::string key;
  std::optional<std::size_t> index;
};

/// "body[0].box.count[2]" as body, 0, box, count, 2; nothing where that is no path.
std::optional<std::vector<Segment>> parse_path(std::string_view text) {
  constexpr std::size_t k_most_segments = 16;  // more than any scene has, and what follows them is recursive
  std::vector<Segment> segments;
  bool key_expected = true;
  while (!text.empty() || key_expected) {
    if (segments.size() > k_most_segments) return std::nullopt;
    if (key_expected) {
      const std::size_t length = std::min(text.find_first_of(".[]"), text.size());
      if (length == 0) return std::nullopt;
      segments.push_back({std::string(text.substr(0, length)), std::nullopt});
      text.remove_prefix(length);
      key_expected = false;
    } else if (text.front() == '.') {
      text.remove_prefix(1);
      key_expected = true;
    } else {
      std::size_t index = 0;
      const std::size_t close = text.find(']');
      if (text.front() != '[' || close == std::string_view::npos) return std::nullopt;
      const auto [end, error] = std::from_chars(text.data() + 1, text.data() + close, index);
      if (error != std::errc() || end != text.data() + close) return std::nullopt;
      segments.push_back({{}, index});
      text.remove_prefix(close + 1);
    }
  }
  return segments;
}

std::string_view trimmed(std::string_view text) {
  constexpr const char* k_blank = " \t\r\n";
  const std::size_t begin = std::min(text.find_first_not_of(k_blank), text.size());
  const std::size_t end = text.find_last_not_of(k_blank);
  return end == std::string_view::npos ? std::string_view{} : text.substr(begin, end + 1 - begin);
}

/// Throws ConfigError where the text starts like a string, list or table but is none.
Node parse_value(std::string_view text) {
  constexpr const char* k_key = "value";
  const std::string_view value = trimmed(text);
  try {
    Node document = parse_document(std::string(k_key) + " = " + std::string(value), {});
    if (document.get_if<Table>()->size() == 1) return std::move(*find(document, k_key));
  } catch (const ConfigError&) {
    constexpr std::string_view k_opening = "\"'[{";
    if (value.empty() || k_opening.find(value.front()) != std::string_view::npos) throw;
  }
  return {.place = {}, .value = std::string(value)};
}

void set_place(Node& node, const Place& place) {
  node.place = place;
  if (Array* array = node.get_if<Array>())
    for (Node& element : *array) set_place(element, place);
  if (Table* table = node.get_if<Table>())
    for (Entry& entry : *table) {
      entry.place = place;
      set_place(entry.node, place);
    }
}

/// The element of a list of that name, or nullptr.
template <class List>
auto named(List& list, const std::string& key) -> decltype(&list.front()) {
  for (auto& element : list) {
    const Node* name = find(element, "name");
    const std::string* text = name ? name->get_if<std::string>() : nullptr;
    if (text && *text == key) return &element;
  }
  return nullptr;
}

constexpr const char* k_materials = "material";

/// "material.dough.alpha" of a scene that has no [[material]] called dough: it gets one with the numbers of
/// the material by that name. What is then wrong with it, such as that no body uses it, the override says.
void take_in_preset(Node& root, const std::vector<Segment>& segments, const Place& place) {
  if (segments.size() < 3 || segments[0].key != k_materials) return;
  const MaterialPreset* preset = find_preset(segments[1].key);
  Table* scene = root.get_if<Table>();
  if (!preset || !scene) return;
  if (!find(root, k_materials)) scene->push_back({k_materials, place, {.place = place, .value = Array{}}});
  Array* list = find(root, k_materials)->get_if<Array>();
  if (!list || named(*list, preset->name)) return;
  SceneMaterial material = scene_material(*preset);
  std::string text;
  for (const BoundField& field : fields(material))
    if (const std::string value = value_text(field); !value.empty())
      text += std::string(field.name) + " = " + value + '\n';
  list->push_back(parse_document(text, {}));
  set_place(list->back(), place);
}

/// Whether the scene or the presets have a material of that name.
bool is_material(const Node& root, const std::string& name) {
  const Node* given = find(root, k_materials);
  const Array* list = given ? given->get_if<Array>() : nullptr;
  return (list && named(*list, name)) || find_preset(name);
}

/// What to say of "material.NAME" where neither the scene nor the presets have the name.
std::string other_materials(const Node& root, const std::string& name) {
  std::vector<std::string> names;
  const Node* given = find(root, k_materials);
  if (const Array* list = given ? given->get_if<Array>() : nullptr)
    for (const Node& element : *list)
      if (const Node* own = find(element, "name"); own && own->get_if<std::string>())
        names.push_back(*own->get_if<std::string>());
  for (const MaterialPreset& preset : material_presets())
    if (std::ranges::find(names, preset.name) == names.end()) names.emplace_back(preset.name);
  return "no material has the name '" + name + "'" + suggestion(name, names);
}

/// Why "section[0]" or "material.NAME" leads nowhere, or nothing; where a scene has no such section, enter()
/// would give it a table.
std::string what_is_missing(const Node& root, const std::vector<Segment>& segments) {
  if (segments.size() < 2) return {};
  const Node* section = find(root, segments[0].key);
  if (segments[1].index) return section ? "" : "there is none";
  if (segments[0].key != k_materials) return {};
  const Array* list = section ? section->get_if<Array>() : nullptr;
  if (section && !list) return {};  // told when it is read
  return list && named(*list, segments[1].key) ? "" : other_materials(root, segments[1].key);
}

/// What `segment` leads to, or nullptr and the reason. Keys that a table does not hold are added to it.
Node* enter(Node& node, const Segment& segment, const Place& place, std::string& why_not) {
  if (segment.index) {
    Array* list = node.get_if<Array>();
    if (list && *segment.index < list->size()) return &(*list)[*segment.index];
    why_not = list ? "there are " + std::to_string(list->size()) + ", counted from 0" : "this is not a list";
    return nullptr;
  }
  if (Table* table = node.get_if<Table>()) {
    if (Node* value = find(node, segment.key)) return value;
    table->push_back({segment.key, place, {.place = place, .value = Table{}}});
    return &table->back().node;
  }
  if (Array* list = node.get_if<Array>()) {
    if (Node* element = named(*list, segment.key)) return element;
    why_not = "none of these has the name '" + segment.key + "'";
    return nullptr;
  }
  why_not = "this is not a table";
  return nullptr;
}

}  // namespace

void apply_override(Node& root, const std::string& override_text, Problems& problems) {
  const Place place{.given_by = "--set " + override_text};
  const std::size_t equals = override_text.find('=');
  const std::string path(trimmed(std::string_view(override_text).substr(0, equals)));
  const auto segments = parse_path(path);
  if (equals == std::string::npos || !segments)
    return problems.add(place, {}, "is not of the form section.key=value or list[0].key=value");

  std::optional<Node> value;
  try {
    value = parse_value(std::string_view(override_text).substr(equals + 1));
  } catch (const ConfigError& error) {
    return problems.add(place, path, error.problems().front().message);
  }
  set_place(*value, place);

  // A list that no scene has: here it is told at once, a table of that name by who reads it.
  const std::string& section = segments->front().key;
  const std::vector<std::string>& known = section_keys();
  if (segments->size() > 1 && (*segments)[1].index && std::ranges::find(known, section) == known.end())
    return problems.add(place, path, "unknown key '" + section + "'" + suggestion(section, known));

  if (segments->size() == 2 && section == k_materials && !(*segments)[1].index &&
      is_material(root, (*segments)[1].key))
    return problems.add(place, path,
                        "is a whole material: give one key of it at a time, as " + path + ".alpha=0.1");
  take_in_preset(root, *segments, place);
  if (const std::string why = what_is_missing(root, *segments); !why.empty())
    return problems.add(place, path, "does not exist: " + why);

  Node* node = &root;
  std::string before;
  for (const Segment& segment : *segments) {
    std::string why_not;
    const Array* list = node->get_if<Array>();
    const bool counted = list && !segment.index && !list->empty() && list->front().get_if<Table>();
    node = enter(*node, segment, place, why_not);
    if (!node && counted) why_not += "; the first is " + element_path(before, 0) + path.substr(before.size());
    if (!node) return problems.add(place, path, "does not exist: " + why_not);
    before = segment.index ? element_path(before, *segment.index) : join_path(before, segment.key);
  }
  *node = std::move(*value);
}

}  // namespace mallow::scene_file

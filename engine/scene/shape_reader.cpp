#include "scene/shape_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <system_error>

#include "files/nearest_name.h"
#include "mallow/files.h"
#include "mallow/level_set.h"
#include "scene/field_reader.h"

namespace mallow::scene_file {
namespace {

template <class Variant>
std::vector<std::string> keys_of(const std::vector<Kind<Variant>>& kinds) {
  std::vector<std::string> keys;
  keys.reserve(kinds.size());
  for (const auto& kind : kinds) keys.emplace_back(kind.key);
  return keys;
}

const std::vector<std::string>& primitive_keys() {
  static const std::vector<std::string> keys = keys_of(primitive_kinds());
  return keys;
}

/// The kind of a key that is known to be one.
template <class Variant>
const Variant& kind_of(const std::vector<Kind<Variant>>& kinds, const std::string& key) {
  return std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) { return kind.key == key; })->value;
}

std::string listed(const std::vector<std::string>& keys) {
  std::string text;
  for (const std::string& key : keys) text += (text.empty() ? "" : ", ") + key;
  return text;
}

/// Six digits, enough for numbers that are estimates or far too large.
std::string rounded_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string text_of(Vec3 v) {
  return value_text({"", &v, k_finite, "", ""});
}

/// The one entry of a table that has one of `keys`; nullptr where there is none. More than one is a problem
/// too.
const Entry* only_one(const Node& node, const std::string& path, const std::vector<std::string>& keys,
                      Problems& problems) {
  const Table* table = node.get_if<Table>();
  if (!table) return nullptr;
  const Entry* found = nullptr;
  for (const Entry& entry : *table) {
    if (std::find(keys.begin(), keys.end(), entry.key) == keys.end()) continue;
    if (found)
      problems.add(entry.place, join_path(path, entry.key),
                   "is not allowed beside " + found->key + ": exactly one of " + listed(keys));
    else
      found = &entry;
  }
  if (!found) problems.add(node.place, path, "has no shape: exactly one of " + listed(keys) + " is needed");
  return found;
}

/// Checks of one value against another, or against what is on the disk.
class ShapeCheck {
 public:
  /// files: those that the shape may name; nullptr where it names none.
  ShapeCheck(const Node& table, const std::string& path, const SceneFiles* files, Problems& problems)
      : table_(table), path_(path), files_(files), problems_(problems) {}

  void operator()(const Lattice& lattice) const {
    double particles = 1;
    for (const int count : lattice.count) particles *= count;
    if (particles > k_most_particles)
      complain("count", rounded_text(particles) + " particles", at_most_particles());
  }

  void operator()(const SphereSource& sphere) const {
    (*this)(sphere.sampling);
    if (!sphere.sampling.spacing) return;
    const float spacing = *sphere.sampling.spacing;
    constexpr double k_unit_ball = 4.18879;  // 4/3 π, its volume
    const double particles = k_unit_ball * std::pow(static_cast<double>(sphere.radius) / spacing, 3);
    if (particles > k_most_particles)
      complain("spacing", number_text(spacing) + ", for about " + rounded_text(particles) + " particles,",
               at_most_particles());
  }

  void operator()(const MeshSource& mesh) const {
    (*this)(mesh.sampling);
    check_file(mesh.file);
  }

  void operator()(const PointsSource& points) const { check_file(points.file); }

  void operator()(const ImplicitSource& implicit) const {
    (*this)(implicit.sampling);
    check_name(implicit.shape, "shape");
  }

  void operator()(const MeshColliderSource& mesh) const { check_file(mesh.file); }

  void operator()(const HullSource& hull) const {
    if (!hull.file.empty() && !hull.points.empty())
      problems_.add(place_of_clash(place_of("points"), place_of("file")), join_path(path_, "points"),
                    "is not allowed beside file: exactly one of the two");
    else if (!hull.file.empty())
      check_file(hull.file);
    else if (hull.points.empty())
      problems_.add(table_.place, path_, "has neither file nor points: exactly one of the two is needed");
  }

  /// key: where the name stands, empty where it is the whole value.
  void check_name(const std::string& shape, const std::string& key) const {
    const auto names = implicit_shape_names();
    const std::vector<std::string> known(names.begin(), names.end());
    if (std::find(known.begin(), known.end(), shape) == known.end())
      problems_.add(place_of(key), key.empty() ? path_ : join_path(path_, key),
                    "unknown shape '" + shape + "'" + suggestion(shape, known));
  }

  /// key: what names it.
  void check_file(const std::filesystem::path& name, const char* key = "file") const {
    // Whoever types a name may well mean another place; the scene's author may not. What lies there is not
    // said.
    const bool typed = !place_of(key).given_by.empty();
    if (!typed && !files_->may_name(name))
      return complain(key, toml_string(name.string()),
                      "a file below " + files_->root().string() +
                          ", unless paths outside are allowed (--allow-outside-paths)");
    const std::filesystem::path file = files_->full_name(name);
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (std::filesystem::is_regular_file(status)) return;
    complain(key, toml_string(name.string()),
             std::filesystem::exists(status) ? file.string() + " is not a file"
                                             : "there is no file " + file.string());
  }

 private:
  static std::string at_most_particles() { return "at most " + std::to_string(k_most_particles); }

  void operator()(const Sampling& sampling) const {
    if (sampling.spacing && sampling.count)
      problems_.add(place_of_clash(place_of("count"), place_of("spacing")), join_path(path_, "count"),
                    "is not allowed beside spacing: exactly one of the two");
    if (!sampling.spacing && !sampling.count)
      problems_.add(table_.place, path_, "has neither spacing nor count: exactly one of the two is needed");
  }

  void complain(const std::string& key, const std::string& given, const std::string& allowed) const {
    problems_.add(place_of(key), join_path(path_, key), not_allowed(given, allowed));
  }

  const Place& place_of(const std::string& key) const {
    const Node* value = find(table_, key);
    return value ? value->place : table_.place;
  }

  const Node& table_;
  const std::string& path_;
  const SceneFiles* files_;
  Problems& problems_;
};

/// Scaled to a longest side, and moved.
Mesh placed(Mesh mesh, const MeshColliderSource& source) {
  const Aabb box = bounds(mesh);
  const Vec3 middle = 0.5f * (box.min + box.max), center = source.center.value_or(middle);
  const float scale = source.size ? *source.size / (box.max - box.min).maxCoeff() : 1.0f;
  for (Vec3& vertex : mesh.vertices) vertex = center + scale * (vertex - middle);
  return mesh;
}

/// Makes shapes of what scenes hold.
struct MakeShape {
  const SceneFiles& files;

  Primitive operator()(const HullSource& source) const {
    return source.file.empty() ? convex_hull(source.points, source.inside)
                               : convex_hull(read_mesh(files.full_name(source.file)).vertices, source.inside);
  }
  Primitive operator()(const MeshColliderSource& source) const {
    return mesh_collider(placed(read_mesh(files.full_name(source.file)), source), source.voxels,
                         source.inside);
  }
  template <class Shape>
  Primitive operator()(const Shape& shape) const {
    return shape;
  }
};

/// One part of a collider.
struct ReadPart {
  Primitive shape;
  ShapeSource source = {};
};

ReadPart read_primitive(const Entry& entry, const std::string& path, const SceneFiles& files,
                        Problems& problems) {
  SceneShape given = kind_of(primitive_kinds(), entry.key);
  const BoundFields table = fields(given);
  if (!read_whole(entry.node, path, table, {}, problems)) return {};
  const std::size_t problems_before = problems.count();
  const auto check = [&]<class Shape>(const Shape& shape) -> std::optional<ShapeProblem> {
    if constexpr (std::is_same_v<Shape, HullSource> || std::is_same_v<Shape, MeshColliderSource>) {
      ShapeCheck(entry.node, path, &files, problems)(shape);
      return std::nullopt;
    } else {
      return ShapeTraits<Shape>::problem(shape);
    }
  };
  const auto problem = std::visit(check, given);
  for (const BoundField& field : table) {
    if (!problem || std::string_view(problem->key) != field.name) continue;
    const Node* at = find(entry.node, field.name);
    problems.add(at ? at->place : entry.place, join_path(path, field.name),
                 not_allowed(value_text(field), problem->allowed));
  }
  if (problems.count() != problems_before) return {};
  ReadPart part;
  if (const auto* hull = std::get_if<HullSource>(&given)) part.source = *hull;
  if (const auto* mesh = std::get_if<MeshColliderSource>(&given)) part.source = *mesh;
  try {
    part.shape = std::visit(MakeShape{files}, given);
  } catch (const ConfigError& error) {
    for (const Problem& one : error.problems()) problems.add(entry.place, path, to_string(one));
  } catch (const IoError& error) {
    problems.add(entry.place, path, to_string(error.problem()));
  }
  return part;
}

std::vector<ReadPart> read_union(const Node& node, const std::string& path, const SceneFiles& files,
                                 Problems& problems) {
  std::vector<ReadPart> parts;
  const Array* list = node.get_if<Array>();
  if (!list || list->empty() || list->size() > k_most_entries) {
    problems.add(node.place, path,
                 not_allowed(describe(node), "a list of 1 to " + std::to_string(k_most_entries) +
                                                 " tables, each with one of " + listed(primitive_keys())));
    return parts;
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string part_path = element_path(path, i);
    if (!read_whole((*list)[i], part_path, {}, primitive_keys(), problems)) continue;
    if (const Entry* entry = only_one((*list)[i], part_path, primitive_keys(), problems))
      parts.push_back(read_primitive(*entry, join_path(part_path, entry->key), files, problems));
  }
  return parts;
}

}  // namespace

const std::vector<std::string>& source_keys() {
  static const std::vector<std::string> keys = keys_of(source_kinds());
  return keys;
}

const std::vector<std::string>& shape_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all = primitive_keys();
    all.emplace_back(k_union_key);
    return all;
  }();
  return keys;
}

void read_source(const Node& body, const std::string& body_path, const SceneFiles& files, BodySource& source,
                 Problems& problems) {
  const Entry* entry = only_one(body, body_path, source_keys(), problems);
  if (!entry) return;
  const std::string path = join_path(body_path, entry->key);
  const ShapeCheck check(entry->node, path, &files, problems);
  source = kind_of(source_kinds(), entry->key);
  ImplicitSource* implicit = std::get_if<ImplicitSource>(&source);
  if (const std::string* name = entry->node.get_if<std::string>(); implicit && name) {
    implicit->shape = *name;
    implicit->sampling.count = k_implicit_count;
    check.check_name(*name, {});
  } else if (read_whole(entry->node, path, fields(source), {}, problems)) {
    std::visit(check, source);
  }
}

void check_file(const Node& table, const std::string& path, const char* key, const SceneFiles& files,
                const std::filesystem::path& name, Problems& problems) {
  if (!name.empty()) ShapeCheck(table, path, &files, problems).check_file(name, key);
}

void read_shape(const Node& table, const std::string& collider_path, const SceneFiles& files,
                SceneCollider& collider, Problems& problems) {
  const Entry* entry = only_one(table, collider_path, shape_keys(), problems);
  if (!entry) return;
  const std::string path = join_path(collider_path, entry->key);
  const bool is_union = entry->key == k_union_key;
  const std::vector<ReadPart> parts = is_union ? read_union(entry->node, path, files, problems)
                                               : std::vector{read_primitive(*entry, path, files, problems)};
  Union shapes;
  bool any_source = false;
  for (const ReadPart& part : parts) {
    shapes.parts.push_back(part.shape);
    collider.sources.push_back(part.source);
    any_source = any_source || part.source.index() != 0;
  }
  if (!any_source) collider.sources.clear();
  if (is_union)
    collider.shape = std::move(shapes);
  else
    std::visit([&](const auto& primitive) { collider.shape = primitive; }, shapes.parts[0]);
}

std::vector<SceneKeyframe> read_keyframes(const Node& table, const std::string& table_path,
                                          Problems& problems) {
  std::vector<SceneKeyframe> keys;
  const Node* node = find(table, k_keyframes_key);
  if (!node) return keys;
  const std::string path = join_path(table_path, k_keyframes_key);
  const Array* list = node->get_if<Array>();
  if (!list || list->empty() || list->size() > k_most_entries) {
    problems.add(
        node->place, path,
        not_allowed(describe(*node), "a list of 1 to " + std::to_string(k_most_entries) + " tables"));
    return keys;
  }
  for (const char* other : {"translate", "rotate", "velocity", "angular_velocity"})
    if (const Node* beside = find(table, other))
      problems.add(place_of_clash(beside->place, node->place), join_path(table_path, other),
                   "is not allowed beside keyframes");
  for (std::size_t i = 0; i < list->size(); ++i) {
    SceneKeyframe& key = keys.emplace_back();
    const std::string key_path = element_path(path, i);
    if (!read_whole((*list)[i], key_path, fields(key), {}, problems)) continue;
    if (i > 0 && !(key.time > keys[i - 1].time))
      problems.add((*list)[i].place, key_path,
                   not_allowed("time " + number_text(key.time), "a time after that of the keyframe before"));
  }
  return keys;
}

bool read_whole(const Node& table, const std::string& path, const BoundFields& fields,
                const std::vector<std::string>& also, Problems& problems) {
  const std::size_t problems_before = problems.count();
  read_fields(table, path, fields, also, problems);
  return problems.count() == problems_before;
}

void check_box(const Aabb& box, const Node& table, const std::string& path, Problems& problems) {
  if ((box.min.array() <= box.max.array()).all()) return;
  problems.add(place_of_clash(find(table, "max")->place, find(table, "min")->place), join_path(path, "max"),
               not_allowed(text_of(box.max), "at least min, " + text_of(box.min) + ", along every axis"));
}

}  // namespace mallow::scene_file

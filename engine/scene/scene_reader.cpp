#include <algorithm>
#include <cerrno>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <system_error>

#include "config/validation.h"
#include "files/nearest_name.h"
#include "mallow/materials.h"
#include "scene/document.h"
#include "scene/field_reader.h"
#include "scene/overrides.h"
#include "scene/scene_fields.h"
#include "scene/shape_reader.h"

namespace mallow {
namespace scene_file {
namespace {

/// How many particles a body says it has; where it says their spacing, or leaves it to a file, at least 1.
struct DeclaredParticles {
  double operator()(const Lattice& lattice) const {
    return 1.0 * lattice.count[0] * lattice.count[1] * lattice.count[2];
  }
  double operator()(const PointsSource&) const { return 1; }
  double operator()(const auto& source) const { return source.sampling.count.value_or(1); }
};

/// Where a field clashes with others that the message names: at the option that gave one of them, else at the
/// table.
const Place& place_of_clash(const Node& table, const std::string& field, const std::string& message) {
  const Table* entries = table.get_if<Table>();
  if (!entries) return table.place;
  for (const Entry& entry : *entries) {
    const bool is_named = field == '.' + entry.key || message.find(entry.key) != std::string::npos;
    if (is_named && !entry.node.place.given_by.empty()) return entry.node.place;
  }
  return table.place;
}

/// Turns a document into a scene and collects what is wrong with it.
class SceneReader {
 public:
  SceneReader(const Node& root, const std::filesystem::path& file, const SceneReadOptions& options,
              Problems& problems)
      : root_(root), files_(file, options.allow_outside_paths), problems_(problems) {
    scene_.file = file;
  }

  Scene read() {
    read_fields(root_, "", {}, section_keys(), problems_);
    read_section("solver", fields(scene_.solver));
    check_update_times();
    read_list("material", 0, &SceneReader::read_material);
    read_list("body", find(root_, "emitter") ? 0 : 1, &SceneReader::read_body);
    read_list("collider", 0, &SceneReader::read_collider);
    read_list("pin", 0, &SceneReader::read_pin);
    read_list("emitter", 0, &SceneReader::read_emitter);
    read_list("sink", 0, &SceneReader::read_sink);
    read_section("surface", fields(scene_.surface));
    read_section("run", fields(scene_.run));
    read_section("render", fields(scene_.render));
    if (const Node* render = find(root_, "render"))
      check_file(*render, "render", "environment", files_, scene_.render.environment, problems_);
    check_view();
    check_materials();
    check_groups();
    check_particles();
    return std::move(scene_);
  }

 private:
  void read_section(const char* key, const BoundFields& table) {
    static const Node k_nothing_given{.place = {}, .value = Table{}};
    const Node* node = find(root_, key);
    read_fields(node ? *node : k_nothing_given, key, table, {}, problems_);
  }

  void check_update_times() {
    if (!scene_.solver.update_period || !scene_.solver.update_interval) return;
    const Node* solver = find(root_, "solver");
    problems_.add(
        place_of_clash(find(*solver, "update_interval")->place, find(*solver, "update_period")->place),
        "solver.update_interval", "is not allowed beside update_period: give one of the two");
  }

  /// Before frames are computed that nothing can draw.
  void check_view() {
    const RenderConfig& render = scene_.render;
    if (!render.eye || !render.target || *render.eye != *render.target) return;
    const Node& given = *find(root_, "render");
    problems_.add(place_of_clash(find(given, "target")->place, find(given, "eye")->place), "render.target",
                  "is not allowed where render.eye is: the camera stands at eye and looks at target");
  }

  void read_list(const char* key, std::size_t at_least,
                 void (SceneReader::*read_element)(const Node&, const std::string&)) {
    const Node* node = find(root_, key);
    if (!node) {
      if (at_least > 0)
        problems_.add({}, key, "is missing: at least one [[" + std::string(key) + "]] is needed");
      return;
    }
    const Array* list = node->get_if<Array>();
    if (!list)
      return problems_.add(
          node->place, key,
          not_allowed(describe(*node), "a list of tables, each under [[" + std::string(key) + "]]"));
    if (list->size() < at_least || list->size() > k_most_entries)
      return problems_.add(node->place, key,
                           not_allowed(describe(*node), "a list of " + std::to_string(at_least) + " to " +
                                                            std::to_string(k_most_entries)));
    lists_[key] = list;
    for (std::size_t i = 0; i < list->size(); ++i) (this->*read_element)((*list)[i], element_path(key, i));
  }

  void read_material(const Node& node, const std::string& path) {
    SceneMaterial& read = scene_.materials.emplace_back();
    read_fields(node, path, fields(read), {}, problems_);
    if (read.material.youngs_modulus && read.material.elastic_time_step)
      problems_.add(
          place_of_clash(find(node, "youngs_modulus")->place, find(node, "elastic_time_step")->place),
          path + ".youngs_modulus", "is not allowed beside elastic_time_step: give one of the two");
  }

  void read_body(const Node& node, const std::string& path) {
    SceneBody& body = scene_.bodies.emplace_back();
    body.line = node.place.line;
    std::vector<std::string> others = source_keys();
    others.emplace_back(k_paint_key);
    read_fields(node, path, fields(body), others, problems_);
    read_paint(node, path, body);
    read_source(node, path, files_, body.source, problems_);
    check_file(node, path, "skin", files_, body.skin, problems_);
  }

  void read_paint(const Node& node, const std::string& body_path, SceneBody& body) {
    const Node* given = find(node, k_paint_key);
    if (!given) return;
    const std::string path = join_path(body_path, k_paint_key);
    const Array* list = given->get_if<Array>();
    if (!list || list->empty() || list->size() > k_most_entries)
      return problems_.add(
          given->place, path,
          not_allowed(describe(*given), "a list of 1 to " + std::to_string(k_most_entries) + " tables"));
    for (std::size_t i = 0; i < list->size(); ++i) {
      ScenePaint& paint = body.paint.emplace_back();
      const std::string paint_path = element_path(path, i);
      read_fields((*list)[i], paint_path, fields(paint), shape_keys(), problems_);
      read_shape((*list)[i], paint_path, files_, paint, problems_);
      paint.pose = pose_of(paint.translate, paint.rotate);
    }
  }

  void read_collider(const Node& node, const std::string& path) {
    SceneCollider& collider = scene_.colliders.emplace_back();
    std::vector<std::string> others = shape_keys();
    others.emplace_back(k_keyframes_key);
    read_fields(node, path, fields(collider), others, problems_);
    read_shape(node, path, files_, collider, problems_);
    read_pose(node, path, collider, problems_);
  }

  void read_pin(const Node& node, const std::string& path) {
    ScenePin& pin = scene_.pins.emplace_back();
    pin.line = node.place.line;
    read_fields(node, path, fields(pin), std::vector<std::string>{"box"}, problems_);
    read_box(node, path, pin.box);
  }

  void read_box(const Node& node, const std::string& path, Aabb& box) {
    if (!node.get_if<Table>()) return;
    const std::string box_path = join_path(path, "box");
    const Node* given = find(node, "box");
    if (!given) return problems_.add(node.place, box_path, "is missing: { min = [...], max = [...] }");
    if (read_whole(*given, box_path, fields(box), {}, problems_)) check_box(box, *given, box_path, problems_);
  }

  void read_emitter(const Node& node, const std::string& path) {
    SceneEmitter& emitter = scene_.emitters.emplace_back();
    emitter.line = node.place.line;
    if (!read_whole(node, path, fields(emitter), {k_keyframes_key}, problems_)) return;
    read_pose(node, path, emitter, problems_);
    Checks checks;
    check(emitter, checks);
    try {
      checks.finish();
    } catch (const ConfigError& error) {
      for (const Problem& problem : error.problems()) {
        const std::string field = problem.field.substr(std::string("emitter").size());
        problems_.add(place_of_clash(node, field, problem.message), path + field, problem.message);
      }
    }
  }

  void read_sink(const Node& node, const std::string& path) {
    SceneSink& sink = scene_.sinks.emplace_back();
    sink.line = node.place.line;
    read_fields(node, path, fields(sink), std::vector<std::string>{"box"}, problems_);
    read_box(node, path, sink.box);
  }

  /// Names are unique, bodies use names that there are, in the scene or as presets, and every material is
  /// used, but for those that a body was taken from by --set: they are left out.
  void check_materials() {
    std::map<std::string, std::size_t> index_of;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      const std::string& name = scene_.materials[i].name;
      if (name.empty()) continue;
      const auto [first, added] = index_of.emplace(name, i);
      if (added)
        known.push_back(name);
      else
        problems_.add(
            place_of("material", i, "name"), element_path("material", i) + ".name",
            "'" + name + "' is not allowed: " + element_path("material", first->second) + " has that name");
    }
    const std::size_t own = scene_.materials.size();
    for (const MaterialPreset& preset : material_presets())
      if (!index_of.contains(preset.name)) known.emplace_back(preset.name);
    std::vector<bool> used(own, false);
    const auto look_up = [&](const char* list, std::size_t i, const std::string& name) {
      if (name.empty()) return;
      if (const auto material = index_of.find(name); material != index_of.end()) {
        if (material->second < own) used[material->second] = true;
      } else if (const MaterialPreset* preset = find_preset(name)) {
        index_of.emplace(name, scene_.materials.size());
        scene_.materials.push_back(scene_material(*preset));
      } else {
        problems_.add(place_of(list, i, "material"), element_path(list, i) + ".material",
                      "unknown material '" + name + "'" + (problems_.full() ? "" : suggestion(name, known)));
      }
    };
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) look_up("body", i, scene_.bodies[i].material);
    for (std::size_t i = 0; i < scene_.emitters.size(); ++i)
      look_up("emitter", i, scene_.emitters[i].material);
    if (scene_.bodies.empty() && scene_.emitters.empty()) return;
    const bool any_taken = is_any_set("body", "material") || is_any_set("emitter", "material");
    std::set<std::size_t> left_out;
    for (const auto& [name, i] : index_of) {
      if (i >= own || used[i]) continue;
      if (any_taken && !is_set((*lists_.at("material"))[i]))
        left_out.insert(i);
      else
        problems_.add(place_of("material", i, "name"), element_path("material", i),
                      "material '" + name + "' is not used by any body");
    }
    for (auto i = left_out.rbegin(); i != left_out.rend(); ++i)
      scene_.materials.erase(scene_.materials.begin() + static_cast<std::ptrdiff_t>(*i));
  }

  /// Whether --set gave a table, or something of it.
  static bool is_set(const Node& table) {
    const Table* entries = table.get_if<Table>();
    return !table.place.given_by.empty() || (entries && std::ranges::any_of(*entries, [](const Entry& entry) {
                                               return !entry.node.place.given_by.empty();
                                             }));
  }
  /// Whether it gave this key of an element of a list.
  bool is_any_set(const char* list, const char* key) const {
    const auto found = lists_.find(list);
    return found != lists_.end() && std::ranges::any_of(*found->second, [&](const Node& table) {
             const Node* value = find(table, key);
             return value && !value->place.given_by.empty();
           });
  }

  /// A group has one material.
  void check_groups() {
    std::map<std::string, std::size_t> first_body;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const SceneBody& body = scene_.bodies[i];
      const bool first = body.group.empty() || first_body.emplace(body.group, i).second;
      if (first || body.material.empty()) continue;
      const std::size_t earlier = first_body[body.group];
      const std::string& material = scene_.bodies[earlier].material;
      if (!material.empty() && material != body.material)
        problems_.add(place_of("body", i, "material"), element_path("body", i) + ".material",
                      "'" + body.material + "' is not allowed: group '" + body.group + "' has material '" +
                          material + "', given by " + element_path("body", earlier));
    }
  }

  /// Bodies that say how many particles they have do not have too many together; of the others build() finds
  /// out.
  void check_particles() {
    double particles = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const double own = std::visit(DeclaredParticles{}, scene_.bodies[i].source);
      // A body that is too large by itself has been told so.
      if (own > k_most_particles) return;
      particles += own;
      if (particles <= k_most_particles) continue;
      return problems_.add(place_of("body", i, ""), element_path("body", i),
                           "is one body too many: with it there are more than " +
                               std::to_string(k_most_particles) + " particles in the scene");
    }
  }

  /// Of a value in a list that was read, or of its table where it is not given.
  const Place& place_of(const char* list, std::size_t index, const char* key) const {
    const Node& table = (*lists_.at(list))[index];
    const Node* value = find(table, key);
    return value ? value->place : table.place;
  }

  const Node& root_;
  SceneFiles files_;
  Problems& problems_;
  Scene scene_;
  /// Those that were read. Looked up in the document for every problem, they would cost its length each time.
  std::map<std::string_view, const Array*> lists_;
};

/// Throws ConfigError where the file cannot be read or is larger than any scene.
std::string read_text(const std::filesystem::path& file) {
  constexpr std::size_t k_most_bytes = std::size_t{16} << 20;
  const auto fail = [&](std::string why) {
    throw ConfigError(std::vector<Problem>{{.file = file.string(), .field = {}, .message = std::move(why)}});
  };
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) fail("cannot be read: it is a folder, not a scene file");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail("cannot be read: " + std::generic_category().message(errno));
  std::string text;
  std::vector<char> block(std::size_t{1} << 16);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > k_most_bytes) fail("is too large for a scene: at most 16 MiB are allowed");
  }
  if (stream.bad()) fail("cannot be read: " + std::generic_category().message(errno));
  return text;
}

}  // namespace
}  // namespace scene_file

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides,
                 const SceneReadOptions& options) {
  return parse_scene(scene_file::read_text(file), file, overrides, options);
}

Scene parse_scene(const std::string& text, const std::filesystem::path& file,
                  std::span<const std::string> overrides, const SceneReadOptions& options) {
  using namespace scene_file;
  Node root = parse_document(text, file.string());
  Problems problems(file.string());
  for (const std::string& override_text : overrides) apply_override(root, override_text, problems);
  Scene scene = SceneReader(root, file, options, problems).read();
  problems.finish();
  return scene;
}

}  // namespace mallow

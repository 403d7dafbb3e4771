#include <algorithm>
#include <string_view>

#include "scene/document.h"
#include "scene/scene_fields.h"

namespace mallow {
namespace scene_file {
namespace {

/// "name = value" lines, with a comment for what is left out.
std::string lines_of(const BoundFields& fields) {
  std::string text;
  for (const BoundField& field : fields) {
    const std::string value = value_text(field);
    text += value.empty() ? "# " + std::string(field.name) + ": " + field.left_out
                          : std::string(field.name) + " = " + value;
    text += '\n';
  }
  return text;
}

/// "{ name = value, ... }".
std::string inline_table(const BoundFields& fields) {
  std::string text;
  for (const BoundField& field : fields) {
    const std::string value = value_text(field);
    if (!value.empty()) text += std::string(text.empty() ? " " : ", ") + field.name + " = " + value;
  }
  return "{" + text + " }";
}

/// What scenes hold of one part: what it was made of, or itself.
SceneShape in_scenes(const Primitive& primitive, const ShapeSource& source) {
  if (const auto* hull = std::get_if<HullSource>(&source)) return *hull;
  if (const auto* mesh = std::get_if<MeshColliderSource>(&source)) return *mesh;
  return std::visit(
      []<class Shape>(const Shape& shape) -> SceneShape {
        if constexpr (std::is_same_v<Shape, ConvexHull>)
          return HullSource{.points = shape.data->corners, .inside = shape.inside};
        else if constexpr (std::is_same_v<Shape, DistanceField>)
          return MeshColliderSource{.inside = shape.inside};
        else
          return shape;
      },
      primitive);
}

std::string shape_text(const SceneCollider& collider) {
  std::size_t part = 0;
  const auto print = [&](const Primitive& primitive) {
    SceneShape shape =
        in_scenes(primitive, part < collider.sources.size() ? collider.sources[part] : ShapeSource{});
    ++part;
    return std::string(key_of(shape)) + " = " + inline_table(fields(shape));
  };
  std::string text;
  const bool is_union = std::holds_alternative<Union>(collider.shape);
  visit_parts(collider, [&](const auto& shape) {
    text += is_union ? (text.empty() ? " { " : ", { ") + print(shape) + " }" : print(shape);
  });
  return is_union ? std::string(k_union_key) + " = [" + text + " ]" : text;
}

/// "paint = [{ ... }, ...]", or nothing.
std::string paint_line(SceneBody& body) {
  std::string text;
  for (ScenePaint& paint : body.paint) {
    const std::string values = inline_table(fields(paint));
    text += (text.empty() ? " { " : ", { ") + shape_text(paint) + ',' + values.substr(1);
  }
  return text.empty() ? text : std::string(k_paint_key) + " = [" + text + " ]\n";
}

/// Of a collider or an emitter; keyframes that it has stand in place of what they set.
template <class Posed>
std::string posed_lines(Posed& posed) {
  BoundFields lines = fields(posed);
  if (posed.scene_keyframes.empty()) return lines_of(lines);
  std::erase_if(lines, [](const BoundField& field) {
    const std::string_view name = field.name;
    return name == "translate" || name == "rotate" || name == "velocity" || name == "angular_velocity";
  });
  std::string text;
  for (SceneKeyframe& key : posed.scene_keyframes)
    text += (text.empty() ? " " : ", ") + inline_table(fields(key));
  return std::string(k_keyframes_key) + " = [" + text + " ]\n" + lines_of(lines);
}

/// To a width in letters: bytes that go on one, as two of m³ do, take no room.
std::string padded(std::string text, std::size_t width) {
  const auto going_on = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; };
  width += static_cast<std::size_t>(std::ranges::count_if(text, going_on));
  text.resize(std::max(text.size(), width), ' ');
  return text + "  ";
}

/// A line of describe_scene_keys(), in columns.
std::string key_line(const std::string& key, const BoundField& field) {
  const std::string value = value_text(field);
  const std::string initially = field.required() ? k_required
                                : value.empty()  ? std::string("left out: ") + field.left_out
                                                 : "default " + value;
  const std::string unit = *field.unit ? " [" + std::string(field.unit) + "]" : "";
  return padded(key, 34) + padded(initially, 34) + field.doc + unit + "; " + allowed(field) + '\n';
}

std::string key_lines(const std::string& path, const BoundFields& fields) {
  std::string text;
  for (const BoundField& field : fields) text += key_line(path + '.' + field.name, field);
  return text;
}

/// "# body[]: exactly one of box, sphere, ... says what shape it has".
std::string choice_line(const std::string& path, const std::string& keys) {
  return "# " + path + ": exactly one of " + keys + " gives its shape\n";
}

template <class Variant>
std::string listed_keys(const std::vector<Kind<Variant>>& kinds) {
  std::string text;
  for (const auto& kind : kinds) text += (text.empty() ? "" : ", ") + std::string(kind.key);
  return text;
}

}  // namespace
}  // namespace scene_file

std::string print_scene(const Scene& scene) {
  using namespace scene_file;
  Scene copy = scene;  // field tables point to what can be written
  std::string text = "[solver]\n" + lines_of(fields(copy.solver));
  for (SceneMaterial& material : copy.materials) text += "\n[[material]]\n" + lines_of(fields(material));
  for (SceneBody& body : copy.bodies)
    text += "\n[[body]]\n" + lines_of(fields(body)) + key_of(body.source) + " = " +
            inline_table(fields(body.source)) + '\n' + paint_line(body);
  for (SceneCollider& collider : copy.colliders)
    text += "\n[[collider]]\n" + shape_text(collider) + '\n' + posed_lines(collider);
  for (ScenePin& pin : copy.pins)
    text += "\n[[pin]]\nbox = " + inline_table(fields(pin.box)) + '\n' + lines_of(fields(pin));
  for (SceneEmitter& emitter : copy.emitters) text += "\n[[emitter]]\n" + posed_lines(emitter);
  for (SceneSink& sink : copy.sinks)
    text += "\n[[sink]]\nbox = " + inline_table(fields(sink.box)) + '\n' + lines_of(fields(sink));
  text += "\n[surface]\n" + lines_of(fields(copy.surface));
  text += "\n[run]\n" + lines_of(fields(copy.run));
  return text + "\n[render]\n" + lines_of(fields(copy.render));
}

std::string describe_scene_keys() {
  using namespace scene_file;
  Scene scene;
  SceneMaterial material;
  SceneBody body;
  SceneCollider collider;
  ScenePin pin;
  const std::string shapes = listed_keys(primitive_kinds()) + ", " + k_union_key;
  std::string text = key_lines("solver", fields(scene.solver)) + key_lines("material[]", fields(material)) +
                     choice_line("body[]", listed_keys(source_kinds())) + key_lines("body[]", fields(body));
  for (const auto& kind : source_kinds()) {
    BodySource source = kind.value;
    text += key_lines(std::string("body[].") + kind.key, fields(source));
  }
  ScenePaint paint;
  const std::string paint_path = std::string("body[].") + k_paint_key + "[]";
  text += choice_line(paint_path, shapes) + key_lines(paint_path, fields(paint));
  text += choice_line("collider[]", shapes) + key_lines("collider[]", fields(collider));
  for (const std::string prefix : {"collider[].", "collider[].union[]."})
    for (const auto& kind : primitive_kinds()) {
      SceneShape shape = kind.value;
      text += key_lines(prefix + kind.key, fields(shape));
    }
  SceneKeyframe keyframe;
  text += key_lines(std::string("collider[].") + k_keyframes_key + "[]", fields(keyframe));
  text += key_lines("pin[]", fields(pin)) + key_lines("pin[].box", fields(pin.box));
  SceneEmitter emitter;
  SceneSink sink;
  text += key_lines("emitter[]", fields(emitter)) +
          key_lines(std::string("emitter[].") + k_keyframes_key + "[]", fields(keyframe)) +
          key_lines("sink[]", fields(sink)) + key_lines("sink[].box", fields(sink.box));
  return text + key_lines("surface", fields(scene.surface)) + key_lines("run", fields(scene.run)) +
         key_lines("render", fields(scene.render));
}

std::string describe_material(const MaterialPreset& preset) {
  using namespace scene_file;
  Material given = preset.material, left_out;
  const BoundFields fields_given = fields(given), fields_left_out = fields(left_out);
  std::string text;
  for (std::size_t i = 0; i < fields_given.size(); ++i) {
    const BoundField& field = fields_given[i];
    const std::string value = value_text(field);
    const bool is_alpha = std::string_view(field.name) == "alpha";  // always told: it says what matter it is
    if (value.empty() || (!is_alpha && value == value_text(fields_left_out[i]))) continue;
    text +=
        padded(field.name, 26) + padded(value + (*field.unit ? " " : "") + field.unit, 18) + field.doc + '\n';
  }
  return text;
}

}  // namespace mallow

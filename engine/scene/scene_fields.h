#pragma once

#include <string>
#include <vector>

#include "colliders/shapes.h"
#include "config/field_tables.h"
#include "config/run_field_tables.h"
#include "mallow/materials.h"
#include "scene/bound_field.h"

/// Every key a scene file may hold, a list per config; bound_field.h makes those of configs that have a
/// table. A list points into the config it was made for.
namespace mallow::scene_file {

/// Those that stand by themselves: [solver], [[body]] and so on.
const std::vector<std::string>& section_keys();

BoundFields fields(SceneMaterial& material);
/// A material by name as a scene holds it.
SceneMaterial scene_material(const MaterialPreset& preset);
BoundFields fields(SceneBody& body);  ///< without its source
BoundFields fields(SphereSource& source);
BoundFields fields(MeshSource& source);
BoundFields fields(PointsSource& source);
BoundFields fields(ImplicitSource& source);
BoundFields fields(SceneCollider& collider);  ///< without its shape
BoundFields fields(ScenePaint& paint);        ///< without its shape
BoundFields fields(HullSource& source);
BoundFields fields(MeshColliderSource& source);
BoundFields fields(SceneKeyframe& keyframe);
BoundFields fields(ScenePin& pin);  ///< without its box
BoundFields fields(SceneEmitter& emitter);
BoundFields fields(SceneSink& sink);  ///< without its box
BoundFields fields(Aabb& box);
BoundFields fields(RenderConfig& render);

/// What scene files hold in place of a shape: itself, or what it is made of.
template <class Shape>
struct InScenes {
  using Type = Shape;
};
template <>
struct InScenes<ConvexHull> {
  using Type = HullSource;
};
template <>
struct InScenes<DistanceField> {
  using Type = MeshColliderSource;
};
template <class... Shapes>
std::variant<typename InScenes<Shapes>::Type...> scene_shape(const std::variant<Shapes...>&);
/// A Primitive as scene files hold it, with the same index.
using SceneShape = decltype(scene_shape(Primitive{}));

inline BoundFields fields(SceneShape& shape) {
  return std::visit([](auto& one) { return fields(one); }, shape);
}

/// One of the keys of which a table must hold exactly one: what a body or a collider is.
template <class Variant>
struct Kind {
  const char* key;
  Variant value;  ///< with its defaults
};
const std::vector<Kind<BodySource>>& source_kinds();     ///< in the order of BodySource
const std::vector<Kind<SceneShape>>& primitive_kinds();  ///< in the order of Primitive

inline BoundFields fields(BodySource& source) {
  return std::visit([](auto& one) { return fields(one); }, source);
}
inline const char* key_of(const BodySource& source) {
  return source_kinds()[source.index()].key;
}
inline const char* key_of(const SceneShape& shape) {
  return primitive_kinds()[shape.index()].key;
}
/// Of list elements: collider[0].keyframes.
inline constexpr const char* k_keyframes_key = "keyframes";

/// Of a body: body[0].paint.
inline constexpr const char* k_paint_key = "paint";

/// Bodies, materials, colliders and pins of a scene, at most of each.
inline constexpr std::size_t k_most_entries = 10'000;
/// Bytes of a name and of a path: they come back in messages, of which one scene may cause a thousand.
inline constexpr std::size_t k_max_name_bytes = 256;
inline constexpr std::size_t k_max_path_bytes = 4096;
/// Particles of a body written as implicit = "moai", those of [TK] Fig. 5(a).
inline constexpr int k_implicit_count = 3764;

}  // namespace mallow::scene_file

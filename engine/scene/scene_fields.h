#pragma once

#include <string>
#include <vector>

#include "colliders/shapes.h"
#include "mallow/scene.h"
#include "scene/field_table.h"

/// The tables of every key a scene file may hold, one per config. A table points into the config it was made
/// for.
namespace mallow::scene_file {

FieldTable fields(SolverConfig& config);
FieldTable fields(SceneMaterial& material);
FieldTable fields(SceneBody& body);  ///< without its source
FieldTable fields(Lattice& lattice);
FieldTable fields(SphereSource& source);
FieldTable fields(MeshSource& source);
FieldTable fields(PointsSource& source);
FieldTable fields(ImplicitSource& source);
FieldTable fields(SceneCollider& collider);  ///< without its shape
FieldTable fields(Primitive& primitive);
FieldTable fields(ScenePin& pin);  ///< without its box
FieldTable fields(Aabb& box);
FieldTable fields(SurfaceConfig& config);
FieldTable fields(RunConfig& config);
FieldTable fields(RenderConfig& config);

/// One of the keys of which a table must hold exactly one: what a body or a collider is.
template <class Variant>
struct Kind {
  const char* key;
  Variant value;  ///< with its defaults
};
const std::vector<Kind<BodySource>>& source_kinds();    ///< in the order of BodySource
const std::vector<Kind<Primitive>>& primitive_kinds();  ///< in the order of Primitive

inline FieldTable fields(BodySource& source) {
  return std::visit([](auto& one) { return fields(one); }, source);
}
inline const char* key_of(const BodySource& source) {
  return source_kinds()[source.index()].key;
}
inline const char* key_of(const Primitive& primitive) {
  return std::visit([](const auto& one) { return mallow::key_of(one); }, primitive);
}

/// Particles of one body and of all together, at most: what 32-bit ids and the memory of one machine leave
/// room for.
inline constexpr int k_most_particles = 100'000'000;
/// Bodies, materials, colliders and pins of a scene, at most of each.
inline constexpr std::size_t k_most_entries = 10'000;
/// Bytes of a name and of a path: they come back in messages, of which one scene may cause a thousand.
inline constexpr std::size_t k_max_name_bytes = 256;
inline constexpr std::size_t k_max_path_bytes = 4096;
/// Particles of a body written as implicit = "moai", those of [TK] Fig. 5(a).
inline constexpr int k_implicit_count = 3764;

}  // namespace mallow::scene_file

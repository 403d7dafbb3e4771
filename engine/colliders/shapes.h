#pragma once

// All shapes of colliders. A new one is three files, say capsule.h, .cpp and _lanes.cpp, and its name in
// - mallow/collider.h: its struct, Primitive and Collider::Shape, nearest() and bounds();
// - nearest.cpp: its nearest(), one line by its lanes;
// - the includes here, and CMakeLists.txt;
// - tools/python/bindings/shapes.cpp, so that Python has it.
// But for the last, the compiler names what is forgotten. Contact, queries, checks, saved states, scene
// files, pictures and the viewer then know it; the viewer draws it by its distances, or as
// tools/view/collider_mesh.cpp says. What its files hold, shape.h and collider_lanes.h say; a shape that is
// heavy holds it in a std::shared_ptr<const ...>.
#include "colliders/box.h"
#include "colliders/capsule.h"
#include "colliders/cone.h"
#include "colliders/cylinder.h"
#include "colliders/distance_field.h"
#include "colliders/hull.h"
#include "colliders/plane.h"
#include "colliders/sphere.h"

namespace mallow {

inline constexpr const char* k_union_key = "union";

template <class... Shapes>
constexpr bool are_collider_shapes(const std::variant<Shapes...>*) {
  return (ColliderShape<Shapes> && ...);
}
static_assert(are_collider_shapes(static_cast<Primitive*>(nullptr)));

template <class Shape>
constexpr const char* key_of(const Shape&) {
  return ShapeTraits<Shape>::k_key;
}
constexpr const char* key_of(const Union&) {
  return k_union_key;
}

/// Makes a variant hold the shape of that key, with its defaults. False where there is none.
template <class... Shapes>
bool take_shape(std::variant<Shapes...>& variant, std::string_view key) {
  const auto take = [&]<class Shape>(Shape&& shape) {
    if (key != key_of(shape)) return false;
    variant = std::move(shape);
    return true;
  };
  return (take(Shapes{}) || ...);
}

}  // namespace mallow

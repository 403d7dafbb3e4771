#pragma once

// All shapes of colliders. A new one is three files, say capsule.h, .cpp and _lanes.cpp, and its name in
// three lists: Primitive and Collider::shape in mallow/collider.h (with its struct), the includes here, and
// CMakeLists.txt. Contact, queries, checks, saved states, scene files and pictures then know it. What its
// files hold, shape.h and collider_lanes.h say; a shape that is heavy holds it in a std::shared_ptr<const
// ...>.
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

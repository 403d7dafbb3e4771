#pragma once

#include "colliders/shapes.h"
#include "core/archive.h"

namespace mallow {

/// A shape by its key and its members; archives of both ways are called alike (core/archive.h).
template <class Archive, class Variant>
void pass_shape(Archive& archive, Variant& shapes) {
  std::string key = std::visit([](const auto& shape) { return std::string(key_of(shape)); }, shapes);
  archive(key);
  if constexpr (!Archive::k_packs)
    if (!take_shape(shapes, key)) archive.fail('\'' + key.substr(0, 32) + "' is not a kind of shape");
  std::visit(
      [&]<class Shape>(Shape& shape) {
        if constexpr (std::is_same_v<std::remove_const_t<Shape>, Union>) {
          if constexpr (Archive::k_packs)
            archive(static_cast<std::uint64_t>(shape.parts.size()));
          else
            shape.parts.resize(archive.count(16));
          for (auto& part : shape.parts) pass_shape(archive, part);
        } else {
          ShapeTraits<std::remove_const_t<Shape>>::visit_members(
              shape, [&](auto& value, const ShapeMember&) { archive(value); });
        }
      },
      shapes);
}

template <class Archive, class Collider>
void pass_collider(Archive& archive, Collider& collider) {
  pass_shape(archive, collider.shape);
  archive.array(collider.pose.translation.data(), 3);
  archive.array(collider.pose.rotation.data(), 4);
  archive(collider.velocity);
  archive(collider.angular_velocity);
  archive(collider.restitution);
  archive(collider.friction);
  archive(collider.measure_load);
}

}  // namespace mallow

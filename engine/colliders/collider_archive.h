#pragma once

#include "colliders/shapes.h"
#include "config/field_archive.h"
#include "config/field_tables.h"

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
          pass_list(archive, shape.parts, 16, [&](auto& part) { pass_shape(archive, part); });
        } else {
          pass_fields(archive, shape);
          using Traits = ShapeTraits<std::remove_const_t<Shape>>;
          if constexpr (requires { Traits::pass_data(archive, shape); }) Traits::pass_data(archive, shape);
        }
      },
      shapes);
}

template <class Archive, class Pose>
void pass_pose(Archive& archive, Pose& pose) {
  archive.array(pose.translation.data(), 3);
  archive.array(pose.rotation.data(), 4);
}

template <class Archive, class Keyframes>
void pass_keyframes(Archive& archive, Keyframes& keyframes) {
  pass_list(archive, keyframes, 8 + 56, [&](auto& key) {
    archive(key.time);
    pass_pose(archive, key.pose);
  });
}

template <class Archive, class Collider>
void pass_collider(Archive& archive, Collider& collider) {
  pass_shape(archive, collider.shape);
  pass_pose(archive, collider.pose);
  pass_fields(archive, collider);
  pass_keyframes(archive, collider.keyframes);
}

}  // namespace mallow

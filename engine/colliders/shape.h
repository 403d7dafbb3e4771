#pragma once

#include <array>
#include <concepts>
#include <limits>
#include <optional>

#include "colliders/collider_lanes.h"
#include "config/field.h"
#include "mallow/collider.h"
#include "mallow/instruction_level.h"

namespace mallow {

/// A member that does not go with the others.
struct ShapeProblem {
  const char* key;
  const char* allowed;
};

/// A place where a line passes a surface, and the normal there, towards the free side.
struct Crossing {
  float t = std::numeric_limits<float>::infinity();
  Vec3 normal{0, 0, 0};
};
/// A line passes a convex shape twice at most; of others the first places in front of its origin are enough.
using Crossings = std::array<Crossing, 4>;

/// What a shape is to the rest of the engine, specialised in its own header. What it does to particles is in
/// its lanes. Exported, as the scene reader and the renderer use it.
template <class Shape>
struct ShapeTraits;

/// What a specialisation has to offer, beside a FieldTable of the members, which ranges, scene fields,
/// archive and messages follow from.
template <class Shape>
concept ColliderShape = requires(const Shape& shape, const Vec3& x, const Eigen::Vector3d& by) {
  /// Its name in scene files and archives.
  { ShapeTraits<Shape>::k_key } -> std::convertible_to<const char*>;
  /// What is wrong with members together that are right one by one.
  { ShapeTraits<Shape>::problem(shape) } -> std::same_as<std::optional<ShapeProblem>>;
  /// Whether particles are kept in.
  { ShapeTraits<Shape>::keeps_in(shape) } -> std::same_as<bool>;
  /// visit_met(shape, visit) calls visit(part) with each shape that a particle meets one after the other.
  /// The shape `by` farther on, as its lanes read it; and them.
  { ShapeTraits<Shape>::numbers(shape, by) } -> std::same_as<ShapeNumbers>;
  { ShapeTraits<Shape>::lanes(InstructionLevel::baseline) } -> std::same_as<const ColliderLanes&>;
  /// Where the line origin + t direction passes the surface; t may be below 0.
  { ShapeTraits<Shape>::cross(shape, x, x) } -> std::same_as<Crossings>;
  /// Of a point of the surface, from the nearest edge; infinite where there are none. Pictures show edges.
  { ShapeTraits<Shape>::edge_distance(shape, x) } -> std::same_as<float>;
  /// As mallow/collider.h has it.
  { bounds(shape) } -> std::same_as<Aabb>;
};

}  // namespace mallow

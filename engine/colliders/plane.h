#pragma once

#include "colliders/shape.h"

namespace mallow {

template <>
struct FieldTable<Plane> {
  static constexpr std::tuple k_fields{
      Field{"normal", &Plane::normal, k_finite, "", "towards the free side, of any length but 0"},
      Field{"offset", &Plane::offset, k_finite, "m", "normal · x >= offset is free"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<Plane> {
  static constexpr const char* k_key = "plane";

  static std::optional<ShapeProblem> problem(const Plane& plane);
  static bool keeps_in(const Plane&) { return false; }
  template <class Visit>
  static void visit_met(const Plane& plane, const Visit& visit) {
    visit(plane);
  }
  static ShapeNumbers numbers(const Plane& plane, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const Plane& plane, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const Plane&, const Vec3&) { return std::numeric_limits<float>::infinity(); }
};

}  // namespace mallow

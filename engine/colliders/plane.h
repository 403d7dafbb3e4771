#pragma once

#include "colliders/shape.h"

namespace mallow {

template <>
struct MALLOW_EXPORT ShapeTraits<Plane> {
  static constexpr const char* k_key = "plane";

  template <class Self, class Visit>
  static void visit_members(Self& plane, const Visit& visit) {
    visit(plane.normal, ShapeMember{"normal", "", "towards the free side, of any length but 0"});
    visit(plane.offset, ShapeMember{"offset", "m", "normal · x >= offset is free"});
  }
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

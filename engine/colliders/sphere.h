#pragma once

#include "colliders/shape.h"

namespace mallow {

template <>
struct MALLOW_EXPORT ShapeTraits<Sphere> {
  static constexpr const char* k_key = "sphere";

  template <class Self, class Visit>
  static void visit_members(Self& sphere, const Visit& visit) {
    using enum ShapeMember::Values;
    visit(sphere.center, ShapeMember{"center", "m", "middle of the ball"});
    visit(sphere.radius, ShapeMember{"radius", "m", "of the ball", positive, true});
    visit(sphere.inside, ShapeMember{"inside", "", "particles are kept in, not out", any});
  }
  static std::optional<ShapeProblem> problem(const Sphere&) { return std::nullopt; }
  static bool keeps_in(const Sphere& sphere) { return sphere.inside; }
  template <class Visit>
  static void visit_met(const Sphere& sphere, const Visit& visit) {
    visit(sphere);
  }
  static ShapeNumbers numbers(const Sphere& sphere, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const Sphere& sphere, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const Sphere&, const Vec3&) { return std::numeric_limits<float>::infinity(); }
};

}  // namespace mallow

#pragma once

#include "colliders/shape.h"

namespace mallow {

template <>
struct FieldTable<Sphere> {
  static constexpr std::tuple k_fields{
      Field{"center", &Sphere::center, k_finite, "m", "middle of the ball"},
      Field{"radius", &Sphere::radius, k_positive, "m", "of the ball", k_required},
      Field{"inside", &Sphere::inside, k_any, "", "particles are kept in, not out"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<Sphere> {
  static constexpr const char* k_key = "sphere";

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

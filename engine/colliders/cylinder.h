#pragma once

#include "colliders/cone.h"

namespace mallow {

template <>
struct FieldTable<Cylinder> {
  static constexpr std::tuple k_fields{
      Field{"start", &Cylinder::start, k_finite, "m", "middle of one flat end"},
      Field{"end", &Cylinder::end, k_finite, "m", "that at the other end", k_required},
      Field{"radius", &Cylinder::radius, k_positive, "m", "of the flat ends", k_required},
      Field{"inside", &Cylinder::inside, k_any, "", "particles are kept in, not out"},
  };
};

/// A cone of two equal radii.
template <>
struct MALLOW_EXPORT ShapeTraits<Cylinder> {
  static constexpr const char* k_key = "cylinder";

  static std::optional<ShapeProblem> problem(const Cylinder& cylinder);
  static bool keeps_in(const Cylinder& cylinder) { return cylinder.inside; }
  template <class Visit>
  static void visit_met(const Cylinder& cylinder, const Visit& visit) {
    ShapeTraits<Cone>::visit_met(as_cone(cylinder), visit);
  }
  static ShapeNumbers numbers(const Cylinder& cylinder, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const Cylinder& cylinder, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const Cylinder& cylinder, const Vec3& x);

 private:
  static Cone as_cone(const Cylinder& c) { return {c.start, c.end, c.radius, c.radius, c.inside}; }
};

}  // namespace mallow

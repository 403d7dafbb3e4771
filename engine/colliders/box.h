#pragma once

#include "colliders/plane.h"

namespace mallow {

template <>
struct FieldTable<Box> {
  static constexpr std::tuple k_fields{
      Field{"min", &Box::min, k_finite, "m", "lowest corner", k_required},
      Field{"max", &Box::max, k_finite, "m", "highest corner", k_required},
      Field{"inside", &Box::inside, k_any, "", "particles are kept in, not out"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<Box> {
  static constexpr const char* k_key = "box";

  static std::optional<ShapeProblem> problem(const Box& box);
  static bool keeps_in(const Box& box) { return box.inside; }
  /// A box that keeps particles in is six planes: in a corner it is met at two or three of them.
  template <class Visit>
  static void visit_met(const Box& box, const Visit& visit) {
    if (!box.inside) return visit(box);
    for (int axis = 0; axis < 3; ++axis) {
      visit(Plane{Vec3::Unit(axis), box.min[axis]});
      visit(Plane{-Vec3::Unit(axis), -box.max[axis]});
    }
  }
  static ShapeNumbers numbers(const Box& box, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const Box& box, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const Box& box, const Vec3& x);
};

}  // namespace mallow

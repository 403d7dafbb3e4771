#pragma once

#include "colliders/plane.h"

namespace mallow {

template <>
struct MALLOW_EXPORT ShapeTraits<Box> {
  static constexpr const char* k_key = "box";

  template <class Self, class Visit>
  static void visit_members(Self& box, const Visit& visit) {
    using enum ShapeMember::Values;
    visit(box.min, ShapeMember{"min", "m", "lowest corner", finite, true});
    visit(box.max, ShapeMember{"max", "m", "highest corner", finite, true});
    visit(box.inside, ShapeMember{"inside", "", "particles are kept in, not out", any});
  }
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

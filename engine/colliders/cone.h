#pragma once

#include "colliders/plane.h"

namespace mallow {

template <>
struct FieldTable<Cone> {
  static constexpr std::tuple k_fields{
      Field{"start", &Cone::start, k_finite, "m", "middle of one flat end, or the tip"},
      Field{"end", &Cone::end, k_finite, "m", "that at the other end", k_required},
      Field{"start_radius", &Cone::start_radius, k_not_negative, "m", "of the flat end at start; 0: the tip",
            k_required},
      Field{"end_radius", &Cone::end_radius, k_not_negative, "m", "of the flat end at end; 0: the tip"},
      Field{"inside", &Cone::inside, k_any, "", "particles are kept in, not out"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<Cone> {
  static constexpr const char* k_key = "cone";

  static std::optional<ShapeProblem> problem(const Cone& cone);
  static bool keeps_in(const Cone& cone) { return cone.inside; }
  /// One that keeps particles in is met at its ends and at its side, one after the other.
  template <class Visit>
  static void visit_met(const Cone& cone, const Visit& visit) {
    if (cone.inside) {
      visit(end_plane(cone.start, cone.end));
      visit(end_plane(cone.end, cone.start));
    }
    visit(cone);
  }
  static ShapeNumbers numbers(const Cone& cone, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const Cone& cone, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const Cone& cone, const Vec3& x);

 private:
  /// Through one end of the axis, free towards the other.
  static Plane end_plane(const Vec3& at, const Vec3& other);
};

}  // namespace mallow

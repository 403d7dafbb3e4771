#pragma once

#include "colliders/plane.h"

namespace mallow {

template <>
struct FieldTable<Capsule> {
  static constexpr std::tuple k_fields{
      Field{"start", &Capsule::start, k_finite, "m", "middle of the ball at one end"},
      Field{"end", &Capsule::end, k_finite, "m", "that at the other end", k_required},
      Field{"radius", &Capsule::radius, k_positive, "m", "of the ball that is drawn along the axis",
            k_required},
      Field{"inside", &Capsule::inside, k_any, "", "particles are kept in, not out"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<Capsule> {
  static constexpr const char* k_key = "capsule";

  static std::optional<ShapeProblem> problem(const Capsule& capsule);
  static bool keeps_in(const Capsule& capsule) { return capsule.inside; }
  template <class Visit>
  static void visit_met(const Capsule& capsule, const Visit& visit) {
    visit(capsule);
  }
  static ShapeNumbers numbers(const Capsule& capsule, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const Capsule& capsule, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const Capsule&, const Vec3&) { return std::numeric_limits<float>::infinity(); }
};

}  // namespace mallow

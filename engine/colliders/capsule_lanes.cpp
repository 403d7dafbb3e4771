// The outside of a capsule, or its inside. Numbers: start and direction of the axis, its length, radius.
#include "colliders/axis_lanes.h"
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct CapsuleLanes {
  AxisLanes axis;
  float radius;
  bool inside;

  explicit CapsuleLanes(const ShapeNumbers& n) : axis(n.at), radius(n.at[7]), inside(n.inside) {}

  Meets meets() const { return inside ? Meets::at_the_end : Meets::on_the_way; }
  Surface nearest(const LaneVec3& x) const {
    const LaneVec3 offset = from_axis(x);
    const Lanes length = norm(offset);
    const Surface s = {length - radius,
                       select(length > k_no_length, offset / length, all_lanes(axis.across))};
    return inside ? Surface{-s.distance, -s.normal} : s;
  }
  /// As of a sphere.
  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const {
    const Lanes distance = squared(from_axis(x));
    const Lanes limit = inside ? radius - reach : radius + reach;
    return inside ? ~((distance < limit * limit) & (limit > 0.0f)) : ~(distance > limit * limit);
  }
  static float least_distance(const ShapeNumbers& capsule, const float* min, const float* max) {
    return least_distance_of_convex<CapsuleLanes>(capsule, capsule.inside, min, max);
  }

 private:
  LaneVec3 from_axis(const LaneVec3& x) const {
    const LaneVec3 offset = x - all_lanes(axis.start), direction = all_lanes(axis.direction);
    const Lanes along = smaller(larger(dot(offset, direction), Lanes{}), all_lanes(axis.length));
    return offset - along * direction;
  }
};

}  // namespace

extern const ColliderLanes capsule_lanes;
const ColliderLanes capsule_lanes = lanes_of<CapsuleLanes>();

}  // namespace mallow::MALLOW_LEVEL

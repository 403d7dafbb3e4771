// The outside of a ball, or its inside. Numbers: centre, radius.
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct SphereLanes {
  const float* center;
  float radius;
  bool inside;

  explicit SphereLanes(const ShapeNumbers& n) : center(n.at), radius(n.at[3]), inside(n.inside) {}

  Meets meets() const { return inside ? Meets::at_the_end : Meets::on_the_way; }
  Surface nearest(const LaneVec3& x) const {
    const LaneVec3 offset = x - all_lanes(center);
    const Lanes length = norm(offset), zero = {};
    const LaneVec3 any_direction = {zero, zero, all_lanes(1.0f)};
    const Surface s = {length - radius, select(length > k_no_length, offset / length, any_direction)};
    return inside ? Surface{-s.distance, -s.normal} : s;
  }
  /// Squares are compared, so that there is no root; "not farther" holds for what is not a number, too.
  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const {
    const Lanes distance = squared(x - all_lanes(center));
    const Lanes limit = inside ? radius - reach : radius + reach;
    return inside ? ~((distance < limit * limit) & (limit > 0.0f)) : ~(distance > limit * limit);
  }
  static float least_distance(const ShapeNumbers& sphere, const float* min, const float* max) {
    float square = 0;
    for (int k = 0; k < 3; ++k) {
      const float below = min[k] - sphere.at[k], above = sphere.at[k] - max[k];
      // The corner that is farthest from the centre, or what the box is beside it.
      float part = sphere.inside ? (below < above ? -below : -above) : (below > above ? below : above);
      part = !sphere.inside && part < 0 ? 0 : part;
      square += part * part;
    }
    const float distance = root(square) - sphere.at[3];
    return sphere.inside ? -distance : distance;
  }
};

}  // namespace

extern const ColliderLanes sphere_lanes;
const ColliderLanes sphere_lanes = lanes_of<SphereLanes>();

}  // namespace mallow::MALLOW_LEVEL

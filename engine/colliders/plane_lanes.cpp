// The half space that a plane leaves free. Numbers: unit normal, offset.
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct PlaneLanes {
  const float* normal;
  float offset;

  explicit PlaneLanes(const ShapeNumbers& n) : normal(n.at), offset(n.at[3]) {}

  Meets meets() const { return Meets::here; }
  Surface nearest(const LaneVec3& x) const {
    const LaneVec3 n = all_lanes(normal);
    return {dot(n, x) - offset, n};
  }
  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const { return ~(nearest(x).distance > reach); }
  static float least_distance(const ShapeNumbers& plane, const float* min, const float* max) {
    float distance = -plane.at[3];
    for (int k = 0; k < 3; ++k) distance += plane.at[k] * (plane.at[k] > 0 ? min[k] : max[k]);
    return distance;
  }
};

}  // namespace

extern const ColliderLanes plane_lanes;
const ColliderLanes plane_lanes = lanes_of<PlaneLanes>();

}  // namespace mallow::MALLOW_LEVEL

// The outside of a box along the axes, or its inside. Numbers: least corner, greatest corner.
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct BoxLanes {
  const float *min, *max;
  bool inside;

  explicit BoxLanes(const ShapeNumbers& n) : min(n.at), max(n.at + 3), inside(n.inside) {}

  /// A box that keeps particles in is met as six planes, see box.cpp.
  Meets meets() const { return Meets::on_the_way; }

  Surface nearest(const LaneVec3& x) const {
    const LaneVec3 zero = {}, below = all_lanes(min) - x, above = x - all_lanes(max);
    const LaneVec3 outside = larger(above, zero) - larger(below, zero);
    const Lanes length = norm(outside);
    const LaneMask is_outside = length > k_no_length;
    const Surface face = nearest_face(below, above);
    const Surface s = {is_outside ? length : face.distance,
                       select(is_outside, outside / length, face.normal)};
    return inside ? Surface{-s.distance, -s.normal} : s;
  }

  /// Squares are compared, so that there is no root; "not farther" holds for what is not a number, too.
  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const {
    const LaneVec3 zero = {}, outside = larger(larger(all_lanes(min) - x, x - all_lanes(max)), zero);
    return ~(squared(outside) > reach * reach);
  }

  static float least_distance(const ShapeNumbers& box, const float* min, const float* max) {
    float square = 0;
    for (int k = 0; k < 3; ++k) {
      const float below = min[k] - box.at[3 + k], above = box.at[k] - max[k];
      const float part = below > above ? below : above;
      square += part > 0 ? part * part : 0.0f;
    }
    return root(square);
  }

 private:
  /// On or in the box the nearest face counts; z wins a tie.
  static Surface nearest_face(const LaneVec3& below, const LaneVec3& above) {
    const Lanes zero = {}, one = all_lanes(1.0f);
    Surface face = {all_lanes(-k_infinity), {zero, zero, one}};
    const auto take_farther = [&](const Lanes& distance, const LaneVec3& normal) {
      const LaneMask farther = distance > face.distance;
      face = {farther ? distance : face.distance, select(farther, normal, face.normal)};
    };
    take_farther(above.z, {zero, zero, one});
    take_farther(below.z, {-zero, -zero, -one});
    take_farther(above.y, {zero, one, zero});
    take_farther(below.y, {-zero, -one, -zero});
    take_farther(above.x, {one, zero, zero});
    take_farther(below.x, {-one, -zero, -zero});
    return face;
  }
};

}  // namespace

extern const ColliderLanes box_lanes;
const ColliderLanes box_lanes = lanes_of<BoxLanes>();

}  // namespace mallow::MALLOW_LEVEL

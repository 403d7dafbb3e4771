// The outside of a convex hull, or its inside. Numbers: where its frame stands, the largest offset of a
// plane, rounding of planes and edges. Data: planes as four floats, outward normal and offset; edges as
// seven, start, direction, length.
//
// In the hull and in front of a face the greatest distance of a plane is the distance. Where the foot of a
// point in that plane is off the hull, the nearest edge counts; corners are ends of edges.
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// How far off the foot of a point may be, in distances of the point.
constexpr float k_foot_rounding = 4e-7f;

struct HullLanes {
  const float* origin;
  float rounding;
  bool inside;
  const float *planes, *edges;
  std::size_t plane_count, edge_count;

  explicit HullLanes(const ShapeNumbers& n)
      : origin(n.at),
        rounding(n.at[4]),
        inside(n.inside),
        planes(n.data[0]),
        edges(n.data[1]),
        plane_count(n.sizes[0]),
        edge_count(n.sizes[1]) {}

  /// One that keeps particles in is met as planes, see hull.h.
  Meets meets() const { return Meets::on_the_way; }

  Surface nearest(const LaneVec3& at) const {
    const LaneVec3 x = at - all_lanes(origin);
    Surface s = farthest_plane(x);
    const LaneVec3 foot = x - s.distance * s.normal;
    const LaneMask off =
        (s.distance > 0.0f) & (farthest_plane(foot).distance > rounding + k_foot_rounding * s.distance);
    if (any(off)) {
      const LaneVec3 offset = from_nearest_edge(x);
      const Lanes length = norm(offset);
      const LaneMask is_edge = off & (length > k_no_length);
      s = {is_edge ? length : s.distance, select(is_edge, offset / length, s.normal)};
    }
    return inside ? Surface{-s.distance, -s.normal} : s;
  }

  /// A plane is never farther than the hull.
  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const {
    const Lanes distance = farthest_plane(x - all_lanes(origin)).distance;
    return ~((inside ? -distance : distance) > reach);
  }

  static float least_distance(const ShapeNumbers& hull, const float* min, const float* max) {
    return least_distance_of_convex<HullLanes>(hull, hull.inside, min, max);
  }

 private:
  Surface farthest_plane(const LaneVec3& x) const {
    Surface s = {all_lanes(-k_infinity), {Lanes{}, Lanes{}, all_lanes(1.0f)}};
    for (std::size_t k = 0; k < plane_count; ++k) {
      const LaneVec3 normal = all_lanes(planes + 4 * k);
      const Lanes distance = dot(normal, x) - planes[4 * k + 3];
      const LaneMask farther = ~(distance <= s.distance);  // what is not a number stays none
      s = {farther ? distance : s.distance, select(farther, normal, s.normal)};
    }
    return s;
  }

  LaneVec3 from_nearest_edge(const LaneVec3& x) const {
    LaneVec3 best = x - all_lanes(edges);  // where no square is finite
    Lanes least = all_lanes(k_infinity);
    for (std::size_t k = 0; k < edge_count; ++k) {
      const float* edge = edges + 7 * k;
      const LaneVec3 direction = all_lanes(edge + 3);
      LaneVec3 offset = x - all_lanes(edge);
      const Lanes along = smaller(larger(dot(offset, direction), Lanes{}), all_lanes(edge[6]));
      offset = offset - along * direction;
      const Lanes square = squared(offset);
      const LaneMask nearer = square < least;
      least = nearer ? square : least;
      best = select(nearer, offset, best);
    }
    return best;
  }
};

}  // namespace

extern const ColliderLanes hull_lanes;
const ColliderLanes hull_lanes = lanes_of<HullLanes>();

}  // namespace mallow::MALLOW_LEVEL

// The outside of a cone that may be cut off, or its inside; a cylinder is one. Numbers: start and direction
// of the axis, its length, radius at the start and at the end, normal of the side: away from the axis and
// along it, length of the side.
//
// In the half plane of radius and height a cone is what is right of the axis and behind three lines: its two
// ends and its side. It is convex, so the greatest of the three distances is the distance in it and beside a
// line; elsewhere the nearest corner counts.
#include "colliders/axis_lanes.h"
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct ConeLanes {
  AxisLanes axis;
  float start_radius, end_radius;
  float outwards, upwards;  ///< normal of the side
  float side;               ///< its length
  bool inside;

  explicit ConeLanes(const ShapeNumbers& n)
      : axis(n.at),
        start_radius(n.at[7]),
        end_radius(n.at[8]),
        outwards(n.at[9]),
        upwards(n.at[10]),
        side(n.at[11]),
        inside(n.inside) {}

  /// One that keeps particles in is met at its ends before, see cone.h.
  Meets meets() const { return inside ? Meets::at_the_end : Meets::on_the_way; }

  Surface nearest(const LaneVec3& x) const {
    const Place p = place(x);
    const Lanes zero = {};
    Lanes distance = p.beside, out = zero + outwards, up = zero + upwards;
    const auto take_farther = [&](const Lanes& other, float upward) {
      const LaneMask farther = other > distance;
      distance = farther ? other : distance;
      out = farther ? zero : out;
      up = farther ? zero + upward : up;
    };
    take_farther(p.below, -1.0f);
    take_farther(p.above, 1.0f);

    const Lanes along = outwards * p.height - upwards * (p.radius - start_radius);  // the side
    const LaneMask at_an_end =
        ((p.below > 0.0f) & (p.radius <= start_radius)) | ((p.above > 0.0f) & (p.radius <= end_radius));
    const LaneMask at_the_side = (p.beside > 0.0f) & (along >= 0.0f) & (along <= side);
    const LaneMask lower = along < 0.5f * side;
    const LaneVec3 corner = {p.radius - (lower ? zero + start_radius : zero + end_radius),
                             lower ? p.height : p.above, zero};
    const Lanes length = norm(corner);
    const LaneMask is_corner = (distance > 0.0f) & ~at_an_end & ~at_the_side & (length > k_no_length);
    distance = is_corner ? length : distance;
    out = is_corner ? corner.x / length : out;
    up = is_corner ? corner.y / length : up;
    const LaneVec3 normal = out * p.outward + up * all_lanes(axis.direction);
    return inside ? Surface{-distance, -normal} : Surface{distance, normal};
  }

  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const {
    if (inside) return ~(nearest(x).distance > reach);
    const Place p = place(x);
    return ~(larger(p.beside, larger(p.below, p.above)) > reach);
  }

  static float least_distance(const ShapeNumbers& cone, const float* min, const float* max) {
    return least_distance_of_convex<ConeLanes>(cone, cone.inside, min, max);
  }

 private:
  struct Place {
    Lanes height, radius;
    LaneVec3 outward;            ///< unit vector across the axis
    Lanes below, above, beside;  ///< in front of the ends and of the side
  };
  Place place(const LaneVec3& x) const {
    const LaneVec3 offset = x - all_lanes(axis.start), direction = all_lanes(axis.direction);
    const Lanes height = dot(offset, direction);
    LaneVec3 across = offset - height * direction;
    across = across - dot(across, direction) * direction;  // once more, for what is far along the axis
    const Lanes radius = norm(across);
    return {height,
            radius,
            select(radius > k_no_length, across / radius, all_lanes(axis.across)),
            -height,
            height - axis.length,
            outwards * (radius - start_radius) + upwards * height};
  }
};

}  // namespace

extern const ColliderLanes cone_lanes;
const ColliderLanes cone_lanes = lanes_of<ConeLanes>();

}  // namespace mallow::MALLOW_LEVEL

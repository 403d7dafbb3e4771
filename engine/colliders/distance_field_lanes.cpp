// The outside of a signed distance field, or its inside. Numbers: lowest point of the grid, voxel size.
// Data: the distances, x fastest; sizes: how many there are along x, y and z.
//
// Between points distances are trilinear, and the normal is the direction in which they grow. Beside the
// grid, at a foot q in its side, the distance is at least √(|x - q|² + d(q)²), as all of the surface is in
// the grid and so behind that side.
#include "colliders/contact_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct DistanceFieldLanes {
  const float* origin;
  float per_voxel, voxel;
  float last[3];  ///< number of the last point along each axis
  bool inside;
  const float* distances;
  std::size_t row, layer;  ///< distances from one point to the next along y and z

  explicit DistanceFieldLanes(const ShapeNumbers& n)
      : origin(n.at),
        per_voxel(1 / n.at[3]),
        voxel(n.at[3]),
        last{static_cast<float>(n.sizes[0] - 1), static_cast<float>(n.sizes[1] - 1),
             static_cast<float>(n.sizes[2] - 1)},
        inside(n.inside),
        distances(n.data[0]),
        row(n.sizes[0]),
        layer(n.sizes[0] * n.sizes[1]) {}

  Meets meets() const { return Meets::on_the_way; }
  float flat_way() const { return 0.5f * voxel; }

  Surface nearest(const LaneVec3& x) const {
    const LaneVec3 at = per_voxel * (x - all_lanes(origin));
    const LaneVec3 held = within(at), beside = voxel * (at - held);
    const Sample s = sample(held);
    const Lanes length = norm(s.gradient);
    const LaneVec3 up = {Lanes{}, Lanes{}, all_lanes(1.0f)};
    Surface result = {s.distance, select(length > k_no_length, s.gradient / length, up)};
    const LaneMask is_beside = (beside.x != 0.0f) | (beside.y != 0.0f) | (beside.z != 0.0f);
    if (any(is_beside)) {
      const LaneVec3 from_foot = beside + result.distance * result.normal;
      const Lanes way = norm(from_foot);
      result = {is_beside ? norm({norm(beside), result.distance, Lanes{}}) : result.distance,
                select(is_beside & (way > k_no_length), from_foot / way, result.normal)};
    }
    return inside ? Surface{-result.distance, -result.normal} : result;
  }

  LaneMask is_near(const LaneVec3& x, const Lanes& reach) const {
    const LaneVec3 at = per_voxel * (x - all_lanes(origin)), held = within(at);
    if (!inside) {
      // Beside the grid nothing is looked up.
      const LaneMask may = ~(squared(voxel * (at - held)) > reach * reach);
      if (!any(may)) return may;
      return may & ~(sample(held).distance > reach);
    }
    return ~(nearest(x).distance > reach);
  }

  static float least_distance(const ShapeNumbers& field, const float* min, const float* max) {
    if (field.inside) return -k_infinity;
    float square = 0;
    for (int k = 0; k < 3; ++k) {
      const float low = field.at[k], high = low + static_cast<float>(field.sizes[k] - 1) * field.at[3];
      const float below = min[k] - high, above = low - max[k];
      const float part = below > above ? below : above;
      square += part > 0 ? part * part : 0.0f;
    }
    return root(square);
  }

 private:
  struct Sample {
    Lanes distance;
    LaneVec3 gradient;  ///< of any length
  };

  LaneVec3 within(const LaneVec3& at) const {
    // What is not a number is taken to be at 0: larger() keeps its first argument then.
    const Lanes zero = {};
    return {smaller(all_lanes(last[0]), larger(zero, at.x)), smaller(all_lanes(last[1]), larger(zero, at.y)),
            smaller(all_lanes(last[2]), larger(zero, at.z))};
  }

  /// at: in voxels, within the grid.
  Sample sample(const LaneVec3& at) const {
    const auto cell = [](const Lanes& along, float most) {
      return converted<Lanes>(converted<LaneMask>(smaller(along, all_lanes(most - 1))));
    };
    const LaneVec3 low = {cell(at.x, last[0]), cell(at.y, last[1]), cell(at.z, last[2])};
    const LaneMask ix = converted<LaneMask>(low.x), iy = converted<LaneMask>(low.y),
                   iz = converted<LaneMask>(low.z);
    float corner[8][k_width];
    for (std::size_t l = 0; l < k_width; ++l) {
      const float* from = distances + static_cast<std::size_t>(ix[l]) +
                          row * static_cast<std::size_t>(iy[l]) + layer * static_cast<std::size_t>(iz[l]);
      corner[0][l] = from[0];
      corner[1][l] = from[1];
      corner[2][l] = from[row];
      corner[3][l] = from[row + 1];
      corner[4][l] = from[layer];
      corner[5][l] = from[layer + 1];
      corner[6][l] = from[layer + row];
      corner[7][l] = from[layer + row + 1];
    }
    const LaneVec3 f = at - low;
    const auto mix = [](const Lanes& a, const Lanes& b, const Lanes& share) { return a + share * (b - a); };
    Lanes edge[4], step[4];  // along x
    for (std::size_t k = 0; k < 4; ++k) {
      const Lanes a = load(corner[2 * k]);
      step[k] = load(corner[2 * k + 1]) - a;
      edge[k] = a + f.x * step[k];
    }
    const Lanes below = mix(edge[0], edge[1], f.y), above = mix(edge[2], edge[3], f.y);
    return {mix(below, above, f.z),
            {mix(mix(step[0], step[1], f.y), mix(step[2], step[3], f.y), f.z),
             mix(edge[1] - edge[0], edge[3] - edge[2], f.z), above - below}};
  }
};

}  // namespace

extern const ColliderLanes distance_field_lanes;
const ColliderLanes distance_field_lanes = lanes_of<DistanceFieldLanes>();

}  // namespace mallow::MALLOW_LEVEL

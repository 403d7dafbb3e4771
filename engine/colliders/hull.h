#pragma once

#include <array>
#include <vector>

#include "colliders/plane.h"
#include "config/field_archive.h"

namespace mallow {

/// What a convex hull is: the common part of half spaces, and where those meet.
struct HullData {
  /// One of the edges of a hull, from `start` on.
  struct Edge {
    std::array<float, 3> start, direction;  ///< [m]; unit length
    float length;                           ///< [m]
  };
  std::vector<Vec3> corners;                 ///< [m]
  std::vector<std::array<float, 4>> planes;  ///< outward normals of unit length, and offsets [m]
  std::vector<Edge> edges;                   ///< between faces that are not in one plane
  float rounding = 0;                        ///< how far off planes and edges may be [m]
};

template <>
struct FieldTable<ConvexHull> {
  static constexpr std::tuple k_fields{
      Field{"inside", &ConvexHull::inside, k_any, "", "particles are kept in, not out"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<ConvexHull> {
  static constexpr const char* k_key = "hull";

  static std::optional<ShapeProblem> problem(const ConvexHull& hull);
  static bool keeps_in(const ConvexHull& hull) { return hull.inside; }
  /// One that keeps particles in is met at all its faces, as a box is.
  template <class Visit>
  static void visit_met(const ConvexHull& hull, const Visit& visit) {
    if (!hull.inside) return visit(hull);
    for (const auto& [x, y, z, offset] : hull.data->planes) visit(Plane{{-x, -y, -z}, -offset});
  }
  static ShapeNumbers numbers(const ConvexHull& hull, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  static Crossings cross(const ConvexHull& hull, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const ConvexHull& hull, const Vec3& x);

  /// What FieldTable has not, in saved states.
  template <class Archive, class Hull>
  static void pass_data(Archive& archive, Hull& hull) {
    HullData data;
    if constexpr (Archive::k_packs) data = *hull.data;
    pass_list(archive, data.corners, 3 * sizeof(float), [&](Vec3& corner) { archive(corner); });
    pass_list(archive, data.planes, 4 * sizeof(float), [&](auto& plane) { archive.array(plane.data(), 4); });
    pass_list(archive, data.edges, 7 * sizeof(float), [&](HullData::Edge& edge) {
      archive.array(edge.start.data(), 3);
      archive.array(edge.direction.data(), 3);
      archive(edge.length);
    });
    archive(data.rounding);
    if constexpr (!Archive::k_packs) hull.data = std::make_shared<const HullData>(std::move(data));
  }
};

}  // namespace mallow

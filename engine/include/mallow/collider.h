#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "mallow/export.h"
#include "mallow/schedule.h"
#include "mallow/vec3.h"

namespace mallow {

struct ImplicitShape;

/// The half space normal · x >= offset is free. The length of the normal is of no matter, in [1e-15, 1e15].
struct Plane {
  Vec3 normal{0, 0, 1};
  float offset = 0.0f;
};

/// Particles are kept out of the ball, or in it.
struct Sphere {
  Vec3 center{0, 0, 0};
  float radius = 1.0f;  ///< > 0
  bool inside = false;  ///< true: particles are kept in
};

/// Particles are kept out of the box along the axes of the collider's frame, or in it. Valid where min < max
/// in every component.
struct Box {
  Vec3 min{0, 0, 0};
  Vec3 max{1, 1, 1};
  bool inside = false;  ///< true: particles are kept in
};

/// All points within `radius` of the line from start to end. Particles are kept out of it, or in it. Valid
/// where start and end are apart by [1e-15, 1e15].
struct Capsule {
  Vec3 start{0, 0, 0};
  Vec3 end{0, 0, 1};
  float radius = 1.0f;  ///< > 0
  bool inside = false;  ///< true: particles are kept in
};

/// A solid cylinder with flat ends, whose axis is the line from start to end. Particles are kept out of it,
/// or in it. Valid where start and end are apart by [1e-15, 1e15].
struct Cylinder {
  Vec3 start{0, 0, 0};
  Vec3 end{0, 0, 1};
  float radius = 1.0f;  ///< > 0
  bool inside = false;  ///< true: particles are kept in
};

/// A solid cone, cut off where both radii are above 0, whose axis is the line from start to end. Particles
/// are kept out of it, or in it. Valid where start and end are apart by [1e-15, 1e15] and a radius is above
/// 0.
struct Cone {
  Vec3 start{0, 0, 0};
  Vec3 end{0, 0, 1};
  float start_radius = 1.0f;  ///< of the flat end at start, >= 0; 0: the tip
  float end_radius = 0.0f;    ///< of the flat end at end, >= 0; 0: the tip
  bool inside = false;        ///< true: particles are kept in
};

struct HullData;
/// The convex hull of points, made by convex_hull(). Particles are kept out of it, or in it.
struct ConvexHull {
  std::shared_ptr<const HullData> data = {};  ///< not null; shared by copies
  bool inside = false;                        ///< true: particles are kept in
};
/// The smallest convex solid that holds all of the points [m]. Throws ConfigError where there are fewer than
/// four of them, one is not finite, all lie in one plane within 1e-4 of their extent, or more than 1024 are
/// corners of the hull. [Barber et al. 1996]
MALLOW_EXPORT ConvexHull convex_hull(std::span<const Vec3> points, bool inside = false);

/// Most points of a DistanceGrid along an axis.
inline constexpr int k_most_grid_points = 1024;
/// Signed distances at the points of a grid along the axes, negative in the solid. Valid where there is a
/// finite distance for each point, and the surface stays within the grid.
struct DistanceGrid {
  Vec3 origin{0, 0, 0};               ///< the lowest point [m]
  float voxel_size = 1.0f;            ///< from one point to the next [m], > 0
  std::array<int, 3> size{0, 0, 0};   ///< points along x, y and z, each in [2, 1024]
  std::vector<float> distances = {};  ///< [m], x fastest, then y
};
/// A solid of any form, by its distances; in between they are trilinear. Particles are kept out of it, or in
/// it. mallow::level_set makes it of a closed mesh: mesh_collider().
struct DistanceField {
  std::shared_ptr<const DistanceGrid> grid = {};  ///< not null; shared by copies
  bool inside = false;                            ///< true: particles are kept in
};
/// Voxels along the longest side of a mesh that is an obstacle, where none are given.
inline constexpr int k_mesh_collider_voxels = 64;
/// An implicit shape on a grid of its own. voxel_size: [m], > 0. band: how far from the surface the distance
/// function tells distances [m], > 0; farther away its sign alone counts. Throws ConfigError where a number
/// is out of range, or the shape has more than 991 voxels along an axis.
MALLOW_EXPORT DistanceField distance_field(const ImplicitShape& shape, float voxel_size, bool inside = false,
                                           float band = std::numeric_limits<float>::infinity());

/// Every shape but the union of them. engine/colliders/shapes.h says what a new one needs.
using Primitive = std::variant<Plane, Sphere, Box, Capsule, Cylinder, Cone, ConvexHull, DistanceField>;

/// Several primitives that act as one obstacle: the nearest one counts. Not empty.
struct Union {
  std::vector<Primitive> parts;
};

/// How a frame stands in the world: its point p is at translation + rotation p. In double, as a step may move
/// it by less than single precision shows.
struct Pose {
  Eigen::Vector3d translation{0, 0, 0};  ///< [m]
  /// Quaternion x, y, z, w, as Eigen::Quaterniond::coeffs() has it; its length is of no matter, but not 0.
  Eigen::Vector4d rotation{0, 0, 0, 1};
};

/// Where a frame stands at a time.
struct PoseKeyframe {
  double time = 0;  ///< simulated time [s], after that of the keyframe before
  Pose pose = {};
};

/// An obstacle: a shape in a frame of its own, how the frame stands and how it moves. Contact is model 2,
/// section 4 A: no penetration, restitution, Coulomb friction.
struct Collider {
  /// What may stand in a frame.
  using Shape = std::variant<Plane, Sphere, Box, Capsule, Cylinder, Cone, ConvexHull, DistanceField, Union>;
  Shape shape = Plane{};
  Pose pose = {};
  Vec3 velocity{0, 0, 0};          ///< of pose.translation [m/s]
  Vec3 angular_velocity{0, 0, 0};  ///< about pose.translation, along the axes of the world [rad/s]
  /// By which the surface itself moves along, as a conveyor's belt does, while the shape stays [m/s]: what of
  /// it is along the normal counts nowhere.
  Vec3 surface_velocity{0, 0, 0};
  float restitution = 0.0f;   ///< e in [0, 1]
  float friction = 0.0f;      ///< μ_f >= 0
  bool measure_load = false;  ///< sum up what particles do to it, see Simulation::load()
  /// Where given, it moves through these poses, with the velocities that follow: evenly from one to the next,
  /// turning the shorter way round. Before the first and after the last it stands still.
  std::vector<PoseKeyframe> keyframes = {};
  /// Of its surface, over time [K]: particles that touch it take heat from it or give it, see
  /// Material::temperature. Left out: no heat passes.
  std::optional<Schedule> temperature = {};
  /// Of what lies between it and what touches it [W/(m² K)], > 0; left out: nothing does.
  std::optional<float> heat_transfer = {};
};

/// What particles gave a collider in one step.
struct ColliderLoad {
  Eigen::Vector3d impulse{0, 0, 0};  ///< momentum that they lost to it [N s]
  Eigen::Vector3d torque{0, 0, 0};   ///< moment of that about pose.translation [N m s]
};

/// The pose after some seconds of its velocities.
MALLOW_EXPORT Pose pose_after(const Collider& collider, double seconds);
/// The pose at a time [s] of what moves through keyframes. keyframes: not empty.
MALLOW_EXPORT Pose pose_at(std::span<const PoseKeyframe> keyframes, double time);

/// Calls visit(part) with each primitive of a collider as what it is.
template <class Visit>
void visit_parts(const Collider& collider, const Visit& visit) {
  if (const Union* shapes = std::get_if<Union>(&collider.shape))
    for (const Primitive& part : shapes->parts) std::visit(visit, part);
  else
    std::visit(
        [&](const auto& shape) {
          if constexpr (!std::is_same_v<decltype(shape), const Union&>) visit(shape);
        },
        collider.shape);
}

/// Signed distance to a shape [m], positive where particles may be, and its gradient (unit length).
/// At a point where the distance has no gradient (a sphere's centre, an axis) the normal is one of the
/// possible ones.
struct SurfacePoint {
  float distance;
  Vec3 normal;
};
/// x in the frame of the shape.
MALLOW_EXPORT SurfacePoint nearest(const Plane& plane, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Sphere& sphere, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Box& box, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Capsule& capsule, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Cylinder& cylinder, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Cone& cone, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const ConvexHull& hull, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const DistanceField& field, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Union& shapes, const Vec3& x);
/// x in the world.
MALLOW_EXPORT SurfacePoint nearest(const Collider& collider, const Vec3& x);

/// The smallest box in the frame of the shape around all points of its surface; infinite where that is.
MALLOW_EXPORT Aabb bounds(const Plane& plane);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const Sphere& sphere);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const Box& box);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const Capsule& capsule);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const Cylinder& cylinder);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const Cone& cone);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const ConvexHull& hull);
/// @copydoc bounds(const Plane&)
MALLOW_EXPORT Aabb bounds(const DistanceField& field);

/// A plane of a frame, in the world, with a unit normal.
MALLOW_EXPORT Plane placed(const Plane& plane, const Pose& pose);
/// The smallest box along the axes of the world around one of a frame.
MALLOW_EXPORT Aabb placed(const Aabb& box, const Pose& pose);

}  // namespace mallow

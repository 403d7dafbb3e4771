#pragma once

#include <variant>
#include <vector>

#include "mallow/export.h"
#include "mallow/vec3.h"

namespace mallow {

/// The half space normal · x >= offset is free. The normal need not have unit length, but must not be zero.
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

/// Particles are kept out of the axis-aligned box, or in it. Valid where min < max in every component.
struct Box {
  Vec3 min{0, 0, 0};
  Vec3 max{1, 1, 1};
  bool inside = false;  ///< true: particles are kept in
};

/// A part of a Union.
using Primitive = std::variant<Plane, Sphere, Box>;

/// Several primitives that act as one obstacle: the nearest one counts. Not empty.
struct Union {
  std::vector<Primitive> parts;
};

/// An obstacle. Contact is model section 5: no penetration, restitution, Coulomb friction.
struct Collider {
  std::variant<Plane, Sphere, Box, Union> shape = Plane{};
  Vec3 velocity{0, 0, 0};    ///< [m/s]; the obstacle moves with it
  float restitution = 0.0f;  ///< e in [0, 1]
  float friction = 0.0f;     ///< μ_f >= 0
};

/// Signed distance to a shape [m], positive where particles may be, and its gradient (unit length).
/// At a point where the distance has no gradient (a sphere's centre) the normal is one of the possible ones.
struct SurfacePoint {
  float distance;
  Vec3 normal;
};
/// Where a shape is seen from x.
MALLOW_EXPORT SurfacePoint nearest(const Plane& plane, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Sphere& sphere, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Box& box, const Vec3& x);
/// @copydoc nearest(const Plane&, const Vec3&)
MALLOW_EXPORT SurfacePoint nearest(const Union& shapes, const Vec3& x);

}  // namespace mallow

#pragma once

#include "mallow/collider.h"
#include "mallow/mesh.h"

namespace mallow::view {

/// The surface of a part of a collider in its frame, to be drawn.
struct ColliderMesh {
  Mesh mesh;             ///< normals point to the outside of the solid
  bool inside = false;   ///< particles are kept in: one looks into it
  bool is_flat = false;  ///< a board: it is seen from its free side
};

/// size: how far planes are drawn [m]. center: what they are drawn around, in the frame [m]. Solids have
/// exact forms; hulls and distance fields are meshed from their distances.
ColliderMesh mesh_of(const Primitive& part, float size, const Vec3& center);

}  // namespace mallow::view

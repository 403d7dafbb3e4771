#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mallow/body.h"
#include "mallow/export.h"
#include "mallow/vec3.h"

namespace mallow {

/// A triangle mesh. Triangles are counter-clockwise seen from outside; indices are valid.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec3> normals;                ///< per vertex, unit length; empty or as long as `vertices`
  std::vector<Vec3> velocities;             ///< per vertex [m/s]; empty or as long as `vertices`
  std::vector<std::uint32_t> material_ids;  ///< per vertex, body the surface belongs to; empty: all 0
};

/// The smallest box that holds all vertices; {0, 0} for an empty mesh.
MALLOW_EXPORT Aabb bounds(const Mesh& mesh);

/// The mesh where place() puts a shape with the bounds `whole`, its own where that is left out: what is drawn
/// for a body goes where the body went. Velocities are left as they are. Throws ConfigError where a value is
/// out of range.
MALLOW_EXPORT Mesh place(Mesh mesh, const Placement& placement, const std::optional<Aabb>& whole = {});

/// The same surface with one vertex for all corners at the same place, where files give each face corners of
/// its own; vertices stand in the order in which they first appear. Triangles that have one place twice are
/// dropped. Of the columns only vertices and triangles are kept.
MALLOW_EXPORT Mesh welded(const Mesh& mesh);

/// What keeps a mesh from enclosing a volume, in words ("12 open edges, the first from (0 0 1) to (0 2 1)"),
/// with corners of open edges that nearly coincide, or an empty string. Closed means: every edge belongs to
/// an even number of triangles, and there is at least one triangle.
MALLOW_EXPORT std::string why_not_closed(const Mesh& mesh);

}  // namespace mallow

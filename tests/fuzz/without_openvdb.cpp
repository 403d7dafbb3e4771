#include "mallow/errors.h"
#include "mallow/level_set.h"

namespace mallow {

// A scene whose collider is a mesh is read up to here; the grid of it takes OpenVDB, which is not compiled
// for the readers.
DistanceField mesh_collider(const Mesh&, int, bool, int) {
  throw ConfigError("mesh", "takes OpenVDB");
}

}  // namespace mallow

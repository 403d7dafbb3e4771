#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>

#include "mallow/export.h"
#include "mallow/surface.h"

/// Surfaces as grids of OpenVDB, for its own tools: target mallow::level_set, which hands OpenVDB on.
namespace mallow {

/// The level set of a surface of the frame that `surfacer` drew last: signed distances [m], negative inside,
/// in a whole band of three voxels on either side, as filters and CSG need it. It is a copy, in the transform
/// of the mesh's voxels; smoothing and adaptivity, which are the mesh's, are not in it. Its zero is within a
/// tenth of a voxel of the mesh, but in creases, as spheres have them. Its name is that of its body
/// (SurfacePart::name) where no other surface of the frame has that, else "surface", or "surface_" and its
/// number where there are several. Metadata say of a surface of one body which that is: `body`, its number,
/// `body_name`, left out where it has none, and `material_id`, its MaterialId. Throws ConfigError where the
/// frame has no such surface.
MALLOW_EXPORT openvdb::FloatGrid::Ptr level_set(const Surfacer& surfacer, std::size_t surface = 0);

}  // namespace mallow

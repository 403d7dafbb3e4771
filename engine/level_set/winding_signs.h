#pragma once

#include <openvdb/Types.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

#include "shapes/orientation.h"

namespace mallow {

/// What the winding numbers of voxels say about a mesh.
struct WindingSummary {
  std::int64_t inside = 0;  ///< voxels
  int highest = 0;          ///< 2 or more where the mesh overlaps itself
  int lowest = 0;           ///< below 0 where it is inside out, or cavities overlap
};

/// Gives distances their sign: negative where the mesh winds around a voxel once or more, by counting the
/// crossings of the mesh with the line of voxels to the right of it. points: vertices in voxels. grid: the
/// unsigned distances of a narrow band, whose background is its width; becomes a level set. Runs in TBB's
/// present arena; same bits for any number of threads.
WindingSummary sign_by_winding(const Orientation& mesh, const std::vector<openvdb::Vec3s>& points,
                               openvdb::FloatGrid& grid);

}  // namespace mallow

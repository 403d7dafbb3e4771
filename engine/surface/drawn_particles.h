#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/threads.h"
#include "surface/picked_vectors.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// All that the mesh of one surface follows from, beside settings that stay.
struct SurfaceSource {
  PickedVectors positions;                ///< [m]
  PickedVectors velocities;               ///< [m/s]; none where vertices have none
  std::span<const std::uint32_t> bodies;  ///< of particles, where surfaces are joined; none: all of one
  float spacing = 0;                      ///< h [m]
  VoxelFrame frame;
};

/// What a surface was drawn from last, to tell whether it would come out the same again. Bits are compared
/// and not how far particles moved: so what is kept is what would be drawn. Takes about a thousandth of the
/// time of a surface.
class DrawnParticles {
 public:
  /// Notes what a surface is drawn from now; returns whether that is, bit by bit, what was noted last.
  bool note(const SurfaceSource& source, const Threads& threads);
  std::size_t bytes() const {
    return (positions_.capacity() + velocities_.capacity()) * sizeof(Vec3) +
           bodies_.capacity() * sizeof(std::uint32_t);
  }

 private:
  std::vector<Vec3> positions_, velocities_;
  std::vector<std::uint32_t> bodies_;
  float spacing_ = 0;
  VoxelFrame frame_;
};

}  // namespace mallow

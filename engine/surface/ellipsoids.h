#pragma once

#include <vector>

#include "core/column.h"
#include "core/threads.h"
#include "surface/particle_cells.h"
#include "surface/surface_lanes.h"

namespace mallow {

/// How the kernels of Yu & Turk 2013 are set up for one kernel radius, so that the flat face of a full body
/// lies at the particle radius, and so does the surface of a lone particle. Lengths in kernel radii unless
/// they say otherwise.
struct AnisotropyModel {
  /// radius: of the kernels; particle_radius: both in spacings.
  AnisotropyModel(double radius, double particle_radius);

  double full_weight = 0;    ///< Σ w inside of a body
  double full_variance = 0;  ///< of its neighbours along an axis
  double shortest_axis = 0;  ///< that a kernel may have
  double lone_axis = 0;      ///< of the kernel of a particle without neighbours, a sphere
  double lone_weight = 0;    ///< its density in the middle
  double threshold = 0;      ///< density of particles at the surface, 1 inside of a body
  double peak = 0;           ///< density in the middle of a full body's kernel times the product of its axes
};

/// Yu & Turk 2013, "Reconstructing surfaces of particle-based fluids using anisotropic kernels", section 4: a
/// kernel for each particle, as long along each axis as its neighbours are spread, about a smoothed centre.
/// Departs:
/// - axes are the square roots of the variances, not these, which would make the kernels of a face thinner
///   than a spacing, so that layers of particles show;
/// - the density at the surface follows from a flat face of a full body, whose outermost particles move 0.34
///   spacings inwards at a radius of two: the face is where it is in all other kinds of surfaces;
/// - between lone particles and full bodies axes and moves are blended; the paper switches at 25 neighbours.
class Ellipsoids {
 public:
  /// Moves the particles to their centres. shapes: by place after that, lengths in radii.
  /// radius: of the kernels [m], that of the cells.
  void fit(const AnisotropyModel& model, float radius, const Threads& threads, ParticleCells& cells);
  const std::vector<Ellipsoid>& shapes() const { return shapes_; }
  std::size_t bytes() const {
    return centers_.bytes() + (shapes_.capacity() + unsorted_.capacity()) * sizeof(Ellipsoid);
  }

 private:
  VectorColumn centers_;
  std::vector<Ellipsoid> unsorted_, shapes_;
};

}  // namespace mallow

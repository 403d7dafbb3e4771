#pragma once

#include <span>
#include <vector>

#include "shape_matching/regions.h"
#include "shape_matching/shape_matching.h"

/// Particles that come to a reference shape or go from it, while all others keep where they rest.
namespace mallow {

/// R of the region that each particle owns, or is in first, as x y z w.
std::vector<Eigen::Vector4f> particle_rotations(const ShapeMatching& shape);
/// build_regions(), but regions start from the rotations of their particles.
void build_regions_from(std::span<const Eigen::Vector4f> rotations, const Execution& execution,
                        RegionScratch& scratch, ShapeMatching& shape);

/// places: of particles, ascending, not all of them. Regions are due to be built.
void erase_from_reference(std::span<const std::uint32_t> places, ShapeMatching& shape);
/// Adds particles at `added` where they would rest: beside the particle that is nearest, as its region is
/// turned; what has none within the region radius goes with the body as a whole. Adds their rotations.
/// positions: of the body, from row `begin` on. Regions are due to be built.
void append_to_reference(const VectorColumn& positions, std::size_t begin, std::span<const Vec3> added,
                         const Execution& execution, std::vector<Eigen::Vector4f>& rotations,
                         ShapeMatching& shape);

}  // namespace mallow

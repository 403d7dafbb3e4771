#pragma once

#include <limits>
#include <span>
#include <vector>

#include "mallow/vec3.h"
#include "shape_matching/regions.h"
#include "shape_matching/shape_matching.h"

/// Particles that come to a reference shape or go from it, while all others keep where they rest.
namespace mallow {

/// What particles take along while others come, go and are sorted: of each, in the order of rows.
struct CarriedRegions {
  std::vector<Eigen::Vector4f> rotations;  ///< R of the region that it owns, or is in first, as x y z w
  std::vector<CarriedStretch> stretches;   ///< S and κ likewise; empty where it does not flow
  std::vector<std::uint32_t> former;       ///< its row when regions were built; of what came k_none
  std::size_t former_rows = 0;             ///< that there were then
  Aabb news;                               ///< in the reference shape, around what came
  /// Of strain, that their new regions may have at the most [m²], see bound_strain().
  double energy = std::numeric_limits<double>::infinity();
};

/// Those of a shape that is built.
CarriedRegions carry_regions(const ShapeMatching& shape);
/// Those of a shape whose reference shape is to be where its particles are now: they keep the elastic strain
/// that they have, and nothing else.
struct ReframedShape {
  CarriedRegions carried;
  bool is_strained = false;  ///< by a blow, see is_strained_by_a_blow()
};
/// The pull is that of now. yield: of those that have none of their own.
ReframedShape reframe_regions(const VectorColumn& positions, std::size_t begin, float yield, int iterations,
                              const Execution& execution, ShapeMatching& shape);
/// Those of a body whose particles come behind: none of their lists is known. Both are of shapes that flow.
void append_carried(const CarriedRegions& behind, CarriedRegions& carried);
/// No list is as it was.
void forget_lists(CarriedRegions& carried);
/// Row k becomes what row order[k] was.
void sort_carried(std::span<const std::uint32_t> order, CarriedRegions& carried);
/// build_regions(), but regions start from the rotations of their particles, and lists that are known are
/// not looked for.
void build_carried(const CarriedRegions& carried, const Execution& execution, RegionScratch& scratch,
                   ShapeMatching& shape);

/// Some particles of a shape as one of their own, in which they rest as they did: its regions are due to be
/// built. places: of them, ascending. carried: what all of the whole carry along; returned for them alone.
struct SplitShape {
  ShapeMatching shape;
  CarriedRegions carried;
};
SplitShape split_off(std::span<const std::uint32_t> places, const CarriedRegions& carried,
                     const ShapeMatching& whole);
/// places: of particles, ascending, not all of them. carried: of a shape that is built, else left as it is.
/// Regions are due to be built.
void erase_from_reference(std::span<const std::uint32_t> places, CarriedRegions& carried,
                          ShapeMatching& shape);
/// Particles of which `yields` is not 0, some but not all, rest anew: beside one that does not, as its region
/// is turned, or beside one that rests beside such a one. All others keep where they rest.
/// positions: of the body, from row `begin` on. Regions are due to be built.
void rest_anew(const VectorColumn& positions, std::size_t begin, std::span<const std::uint8_t> yields,
               const Execution& execution, CarriedRegions& carried, ShapeMatching& shape);
/// Adds particles at `added` where they would rest: in the mean of where those of the body within the region
/// radius would have them, as their regions are turned, or, where there are none, added ones that rest beside
/// such, and so on; what nothing reaches goes with the body as a whole.
/// positions: of the body, from row `begin` on. Regions are due to be built.
void append_to_reference(const VectorColumn& positions, std::size_t begin, std::span<const Vec3> added,
                         const Execution& execution, CarriedRegions& carried, ShapeMatching& shape);

}  // namespace mallow

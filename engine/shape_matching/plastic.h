#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/column.h"
#include "core/execution.h"
#include "neighbors/neighbor_lists.h"

/// Yield and creep where the strain is: every region has a plastic stretch of its own. [model 2, section 5;
/// Mueller 2005, kept local] What flows in a step is in plastic_lanes.h; this is what is seldom done. Departs
/// from the model's print: a new frame adds no energy, see bound_strain().
namespace mallow {

struct ShapeMatching;

/// When and how fast regions flow.
struct FlowRule {
  float yield = 0;  ///< strain |Ê − I| beyond which they do
  float creep = 0;  ///< rate at which what is beyond goes into S [1/s]; infinite: at once
};

/// κ of a region from which the body gets a new frame: S would take it too far from its reference shape.
inline constexpr float k_far_flow = 0.5f;
/// κ of both that tear between checks. What a blade drives apart flows by far more; to look at all that
/// creeps would take as long as an elastic step.
inline constexpr float k_torn_flow = 0.1f;
/// κ of half of the regions from which it gets one at once: pastes that hit a floor get there in a fraction
/// of the time between checks, and with S so far from I hardly resist any more.
inline constexpr float k_farthest_flow = 1.2f;
/// |Ê − I| beyond which a region is strained by a blow, or twice its yield where that is more. A new frame
/// clips what is beyond, and its list is a ball while it is strained, no longer when it is let go.
inline constexpr float k_much_strain = 0.25f;

/// A row a region; empty where nothing flows.
struct PlasticColumns {
  std::array<Column<float>, 9> stretch;  ///< S_j, row by row; what flows keeps its determinant
  Column<float> flow;                    ///< κ_j since the reference shape was taken
  Column<float> yield;                   ///< strain from which it flows; empty where it is the same for all

  std::size_t bytes() const;
};

/// S_j and κ_j of one region, as particles carry them along.
struct CarriedStretch {
  Eigen::Matrix3f stretch = Eigen::Matrix3f::Identity();
  float flow = 0;
};
CarriedStretch carried_stretch(const PlasticColumns& columns, std::size_t region);
void set_stretch(const CarriedStretch& carried, std::size_t region, PlasticColumns& columns);
/// Room for the regions of a shape, with S = I and κ = 0; none where it does not flow.
void reset_stretches(ShapeMatching& shape);
/// S B Sᵀ of a region, and whether that is too thin for it to flow.
Eigen::Matrix3d stretched_moment(const ShapeMatching& shape, std::size_t region);
bool is_thin(const Eigen::Matrix3d& moment);

/// A region whose frame becomes where its particles are.
struct ReframedRegion {
  /// S: R E⁻¹ Rᵀ, so that the elastic strain E that it has stays, as far as its eigenvalues are between 0.8
  /// and 1.25. I where the region is thin.
  Eigen::Matrix3f stretch = Eigen::Matrix3f::Identity();
  double strain = 0;  ///< |Ê − I|, 0 where it is thin
  double fit = 0;     ///< tr P − 2 tr(Rᵀ M): with Σ w |x − c|² it is Σ w |x − goal|² [m²]
};
/// m: M of plastic_lanes.h, moment: S B Sᵀ.
ReframedRegion reframed_region(const Eigen::Matrix3d& m, const Eigen::Matrix3d& rotation,
                               const Eigen::Matrix3d& moment);
/// Brings all S as much nearer to I as leaves regions that have just got their frame no more than this
/// energy, ½ Σ w |x − goal|² of all [m²]: what was crushed has more particles, and farther off, in new
/// regions, which by the same strain would pull harder.
void bound_strain(double energy, ShapeMatching& shape);
/// What gives a body a new frame, see Material.
struct FrameLimits {
  float merge_flow = 0, tear_strain = 0;
  float least_flow = 0;  ///< κ of both that tear is above this
};
/// What a look at what has flowed needs; all bodies take turns with it.
struct FlowScratch {
  Column<std::uint32_t> which;  ///< particles that have
  VectorColumn here, rest;      ///< where they are, and where they rest [m]
  CellGrid grid;
  NeighborLists lists;

  std::size_t bytes() const {
    return which.bytes() + here.bytes() + rest.bytes() + grid.bytes() + lists.bytes();
  }
};
/// Particles of a body, ascending, in regions that have flowed by more than `least`.
void list_flowed(float least, const ShapeMatching& shape, Column<std::uint32_t>& which);
/// Whether two of a body, from row `begin` on, that are in one's region, and have flowed by more than
/// least_flow, are farther apart than 1 + tear_strain of its radius: then it tears, and its positions should
/// become its reference shape.
bool is_torn(const VectorColumn& positions, std::size_t begin, const FrameLimits& limits,
             const Execution& execution, const ShapeMatching& shape, FlowScratch& scratch);
/// Whether they should for another reason: a region has flowed by more than k_far_flow; or two that are in no
/// region of each other are nearer than a spacing, and both have flowed by more than merge_flow, so that they
/// merge.
bool reframe_is_due(const VectorColumn& positions, std::size_t begin, const FrameLimits& limits,
                    const Execution& execution, const ShapeMatching& shape, FlowScratch& scratch);
/// Whether half of the regions have flowed by more than k_farthest_flow, so that no check is waited for.
bool has_flowed_too_far(const ShapeMatching& shape);
/// Whether half of the regions are strained beyond k_much_strain and twice their yield: a blow that has them
/// is over in less than the time between checks, and a new frame in it would take the rebound from one
/// spacing and not from another.
bool is_strained_by_a_blow(const std::vector<ReframedRegion>& regions, float yield,
                           const ShapeMatching& shape);

}  // namespace mallow

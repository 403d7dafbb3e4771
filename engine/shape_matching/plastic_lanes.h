#pragma once

#include "shape_matching/shape_lanes.h"

namespace mallow {

/// det P over (tr P/3)³ of regions that are too thin to flow, which bounds S.
inline constexpr float k_thin = 1e-4f;
/// det B over (tr B/3)³ likewise: a layer of particles has no strain across. Displaced by a fifth of a
/// spacing it is about 0.04, and what it says of strain across is noise: such a layer gained two thirds of
/// its energy in five steps. Two layers have 0.6, two rows of two 0.2.
inline constexpr float k_single_layer = 0.1f;

/// Regions with a plastic stretch S_j: R_j S_j stands where RotationLanes has R_j, and S_j flows.
/// [model 2, section 5; Mueller 2005, kept local]
///
/// symbol | where         | meaning
/// S      | stretch       | plastic stretch; 9 columns, row by row
/// κ      | flow          | Σ |G − I| since the last frame
/// M      | sums row      | A Sᵀ, whose polar factor R is
/// P      | of a step     | S B Sᵀ, the moment of the stretched reference shape
/// E      | of a step     | sym(Rᵀ M P⁻¹), the elastic strain: with F = A B⁻¹ S⁻¹ this is sym(Rᵀ F), and no
/// S⁻¹ is needed Ê, e   | of a step     | E/det(E)^⅓, |Ê − I| G      | of a step     | I + y (Ê − I), scaled
/// to det 1; y = (1 − yield/e) share
struct FlowInput {
  float yield;          ///< strain from which regions flow
  const float* yields;  ///< where they differ; null: `yield` for all
  float share;  ///< of what is beyond, that flows in this step: 1 − exp(−creep Δt); 0: nothing flows
};
/// Of `undecided`: of a region whose row is not finished, and of one whose rotation is open besides.
inline constexpr std::uint8_t k_unfinished = 1, k_open = 2;

struct PlasticLanes {
  /// As RotationLanes::solve, of M_j, which goes in front of every sums row; the last three sums stay.
  /// Registers of regions that all are decided are finished at once, where there is a rule.
  void (*solve)(const ShapeInput&, const FlowInput* rule, std::size_t begin, std::size_t end, int iterations,
                float* sums, float* const* rotation, float* const* stretch, float* flow,
                std::uint8_t* undecided) noexcept;
  /// Of what solve() left unfinished, rotations known: replaces rows by R S − R_g (row by row) and u of the
  /// centre − (R S − R_g) c̄, then lets S and κ flow, for the next step. What is thin (k_thin), mirrored or
  /// not finite does not flow, nor what is crushed or torn where that would add to tr((E − G)² P), its energy.
  void (*finish)(const ShapeInput&, const FlowInput&, std::size_t begin, std::size_t end,
                 const std::uint8_t* undecided, const float* const* rotation, float* sums,
                 float* const* stretch, float* flow) noexcept;
};
MALLOW_DECLARE_LEVELS(PlasticLanes, plastic_lanes)

}  // namespace mallow

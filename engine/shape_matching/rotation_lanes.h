#pragma once

#include "shape_matching/shape_lanes.h"

namespace mallow {

/// Iterations within which any region converges that Newton's method can decide; what has not by then is
/// solved otherwise.
inline constexpr int k_enough_iterations = 8;

/// R_j, the rotation that maximises tr(Rᵀ A_j), by Newton's method from the last rotation: the Hessian form
/// of Kugelstadt et al. 2018, whose every step is corrected to the next odd order.
///
/// symbol | where        | meaning
/// M      | of a step    | Rᵀ A with the rotation R that the step starts from
/// b      | of a step    | axial(M), the gradient
/// H      | of a step    | tr(S) I − S with S = (M + Mᵀ)/2, the Hessian
/// ω      | of a step    | H⁻¹ b; where A is round, the axis times the tangent of the turn that is left
/// c      | of a step    | ((ω·b) H⁻¹ ω − |ω|² ω)/4: what the tangent is off by elsewhere, in third order
struct RotationLanes {
  /// A_j = R_g B_j + Σ w u x̄ᵀ − (Σ w u) c̄ᵀ, R_j by at most `iterations` steps from the last rotation.
  /// Replaces sums row j by R_j − R_g (row by row) and u of the centre − (R_j − R_g) c̄. Regions that Newton
  /// cannot decide (singular, mirrored, far away) keep their sums row, with their A in front, and get
  /// undecided[j] = 1. With fewer than k_enough_iterations a region whose Hessian is definite is decided
  /// where it has got to; with 0 none is. begin: a multiple of k_lanes.
  void (*solve)(const ShapeInput&, std::size_t begin, std::size_t end, int iterations, float* sums,
                float* const* rotation, std::uint8_t* undecided) noexcept;
};
MALLOW_DECLARE_LEVELS(RotationLanes, rotation_lanes)

}  // namespace mallow

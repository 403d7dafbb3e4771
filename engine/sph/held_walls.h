#pragma once

#include "sph/walls.h"

namespace mallow {

/// A body that sticks to colliders.
struct HeldBody {
  std::size_t number;  ///< in Walls::bodies
  float spacing;       ///< h [m]
  float inward;        ///< how far behind a surface the matter of a wall begins: h/2 − contact_offset [m]
  float viscosity;     ///< μ [Pa s]
  float adhesion;      ///< stress that it sticks with [Pa]
  float mass;          ///< m [kg]
};

/// What holding reads, by row of the store.
struct HoldInput {
  const VectorColumn& position;
  const std::uint16_t* pin;  ///< rows whose pin is not 0 are not held; null: all are
  const float* viscosity;    ///< μ [Pa s]; null: that of each body
  const float* alpha;        ///< what is below 1 is left to friction; null: all is a fluid
  float time_step;           ///< Δt [s]
};
/// v' -> v' of the layer beside walls, which does not slip, and loads. A wall has the shear stress of a flow
/// that is at rest in it, μ w/d at a distance d from it, up to adhesion and Coulomb's share of what it has
/// pushed with: of a layer h thick it takes e^-(μ Δt/(ρ h d)), which is stable at any step. rub_walls()
/// finds nothing left to rub then.
void hold_at_walls(const HoldInput& in, const HeldBody& body, std::span<const PlacedCollider> colliders,
                   const Execution& execution, Walls& walls, VectorColumn& velocity);

}  // namespace mallow

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "colliders/contact.h"
#include "core/column.h"
#include "core/execution.h"
#include "core/range_blocks.h"
#include "heat/heat_lanes.h"
#include "heat/heat_lattice.h"
#include "sph/sph.h"

namespace mallow {

/// What a material does with heat.
struct HeatConstants {
  double conductivity = 0;           ///< κ [W/(m K)]
  double specific_heat = 1;          ///< c [J/(kg K)]
  double latent_heat = 0;            ///< L [J/kg], taken up evenly from solidus to liquidus
  double solidus = 0, liquidus = 0;  ///< [K]
  double heat_transfer = 0;          ///< to the air [W/(m² K)]

  /// Heat that takes a kilogram from the solidus to T [J/kg], and T [K] of it.
  double enthalpy(double temperature) const;
  double temperature(double enthalpy) const;
};

/// A body that carries heat.
struct HeatedBody {
  std::size_t begin, end;  ///< rows
  std::uint32_t group;     ///< of SPH
  float spacing;           ///< h [m]
  double mass;             ///< m [kg]
  float inward;  ///< how far behind what it touches a collider's surface lies: contact_offset − h/2 [m]
  HeatConstants constants;
  HeatLattice lattice;
};
/// A collider, in the order of all.
struct HeatedCollider {
  bool is_heated = false;
  double temperature = 0;       ///< [K]
  double inverse_transfer = 0;  ///< of what lies between it and a body [m² K/W]
};

/// What of a scene carries heat. Temperatures are those of the store: a float and what it leaves out of a
/// double, as what a step adds is often less than a float shows.
struct Heat {
  std::vector<HeatGroup> groups;  ///< those of SPH
  std::vector<HeatLattice> lattices;
  std::vector<HeatedBody> bodies;
  std::vector<HeatedCollider> colliders;
  double air_temperature = 0;  ///< [K]

  // Scratch.
  RangeBlocks blocks;
  Column<float> sorted, openness;   ///< T and what pairs count by, in the order of SPH
  Column<float> flow, conductance;  ///< by row [W], [W/K]
  std::vector<std::vector<NearWall>> near;
  struct Surface {
    double conductance;  ///< to all that it touches, air too [W/K]
    double flow;         ///< where it is 0 K itself [W]
  };
  std::vector<Surface> surface;  ///< by row
  std::vector<double> fastest;   ///< by block

  std::size_t bytes() const;
};

/// Where a step finds and leaves temperatures, by row of the store.
struct HeatedColumns {
  const VectorColumn& position;
  const VectorColumn& velocity;
  Column<float>& temperature;
  Column<float>& rest;  ///< what `temperature` leaves out
};

/// Most parts that a step is cut into. A particle takes on at most its neighbours' mean in one: T stays
/// within what it was.
inline constexpr double k_most_heat_parts = 200;

/// Conducts for time_step [s], over lists of SPH that are those of these positions: explicit, in as many
/// equal parts as stability takes. placed: all colliders. Returns how many; where that is above
/// k_most_heat_parts nothing is changed.
double conduct(const Sph& sph, std::span<const PlacedCollider> placed, double time_step,
               const Execution& execution, const HeatedColumns& columns, Heat& heat);

}  // namespace mallow

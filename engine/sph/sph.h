#pragma once

#include <span>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "mallow/solver_config.h"
#include "neighbors/cell_grid.h"
#include "neighbors/kept_lists.h"
#include "neighbors/neighbor_lists.h"
#include "sph/kernel_functions.h"
#include "sph/sph_lanes.h"
#include "sph/walls.h"

namespace mallow {

/// What the SPH phases of a scene own; empty in a scene without SPH.
struct Sph {
  KernelFactors factors{};
  DensityKernel kernel = DensityKernel::poly6;
  float support_radius = 0;  ///< σ [m]
  Formulation formulation = Formulation::conservative;
  bool viscous = false;      ///< some group has μ > 0
  float neighbor_slack = 0;  ///< share of σ by which lists reach farther
  bool native = false;       ///< sums are of Arithmetic::native
  /// Constants of particles that act on each other as parts of one body: that of one body, or of several
  /// that merge.
  std::vector<SphGroup> groups;
  bool apart = false;        ///< pairs of two groups add nothing
  bool keeps_lists = false;  ///< others want to see all that is within σ, of other groups too
  /// The rows up to `end`, behind those of the body before.
  struct Body {
    std::size_t end;
    std::uint32_t group;
  };
  std::vector<Body> bodies;

  /// Rows of the particles that take part, ascending; empty: all do.
  Column<std::uint32_t> rows;
  CellGrid grid;
  NeighborLists lists;  ///< a list per cluster of the grid
  KeptLists kept;       ///< empty without slack
  Walls walls;
  // Sorted order.
  Column<std::uint32_t> group;     ///< empty where there is one group
  VectorColumn velocity;           ///< empty without viscosity
  Column<float> alpha, viscosity;  ///< see ByParticle
  Column<float> density, pressure, volume;
  // By row of the particle store; of those that take part.
  std::size_t store_rows = 0;
  Column<float> density_by_row;
  VectorColumn acceleration;  ///< a^SPH: pairs of one group [m/s²]
  VectorColumn cross_group;   ///< pairs of two groups, part of a_ext [m/s²]; empty where there is one group,
                              ///< or they are apart

  // Scratch.
  VectorColumn positions;  ///< of `rows`

  std::size_t bytes() const;
};

/// Clusters that one thread handles at a time.
inline constexpr std::size_t k_cluster_block = 16;

/// Cell grid and, per cluster of it, the list of all particles within σ. With slack, lists that still hold
/// all of these are kept, and only their positions are brought up to date. Tells whether lists were found
/// anew.
bool find_neighbors(const VectorColumn& positions, const Execution& execution, Sph& sph);
/// A column by row of the store -> the same in sorted order.
void gather_sorted(const VectorColumn& by_row, const Sph& sph, const Execution& execution,
                   VectorColumn& sorted);
/// Density and pressure from the lists, which keep only who is nearer than σ unless they are kept for later
/// steps. [TK eq. 3, model 1]
void compute_density(const Execution& execution, Sph& sph);
/// What particles have of their own, by row.
struct ByParticle {
  const Column<float>& alpha;      ///< empty: sums within a body are those of alpha 1, else blended by pair
  const Column<float>& viscosity;  ///< empty: that of their groups [Pa s]
};
/// Pressure and viscosity accelerations. [TK eq. 1, 2, 4, model 1] [model 2, section 7]
void compute_accelerations(const VectorColumn& velocities, const ByParticle& own, const Execution& execution,
                           Sph& sph);

}  // namespace mallow

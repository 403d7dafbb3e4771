#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "core/column.h"
#include "core/isa.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"
#include "shape_matching/rotation_kernels.h"
#include "shape_matching/shape_kernels.h"

namespace mallow {

/// The rigid motion that takes a group's reference shape nearest to where it is: x ≈ R x̄ + t.
struct RigidFrame {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation{0, 0, 0};
};

/// Shape matching of one group: its reference shape and the regions on it. Particles are counted from the
/// group's first, regions by their owners in the order of particles: with a stride of 1 every particle owns a
/// region, and region j is that of particle j.
struct ShapeMatching {
  float region_radius = 0;  ///< [m]
  int region_stride = 1;    ///< every so many particles one owns a region; >= 1
  VectorColumn reference;   ///< x̄ relative to the group's centre [m]
  bool built = false;       ///< the regions belong to the reference shape

  NeighborLists regions;  ///< per region: its particles
  NeighborLists
      memberships;  ///< per particle: its regions; empty with a stride of 1, where `regions` says it
  double average_neighbors = 0;  ///< mean |N_i| of all particles, whatever the stride
  // A row a region.
  Column<float> region_weight;            ///< W_j
  VectorColumn center;                    ///< c̄_j [m]
  std::array<Column<float>, 6> moment;    ///< B_j [m²]
  std::array<Column<float>, 4> rotation;  ///< R_j as x y z w
  Column<float> sums;                     ///< k_row floats a region
  Column<std::uint8_t> undecided;
  // A row a particle.
  Column<float> weight;  ///< w_i
  Column<float> rows;    ///< k_row floats a particle
  VectorColumn pull;     ///< g − x [m]

  double total_moment = 0;  ///< trace of Σ x̄ x̄ᵀ / n [m²]
  RigidFrame frame;
  std::vector<std::array<double, 12>> partial;

  std::size_t bytes() const;
};

/// x̄ ← x of the rows [begin, end) of a store. Rotations start from none; regions are due to be built.
void update_reference(const VectorColumn& positions, std::size_t begin, std::size_t end,
                      ShapeMatching& shape);
/// Regions of the reference shape: owners, lists, weights, centres, moments. One of every region_stride
/// particles owns a region, and so does every particle that is in none of theirs. Fast where the particles
/// lie in cell order, so that a region's rows lie near each other, and owners are spread evenly. `grid` is
/// scratch.
void build_regions(int threads, InstructionLevel level, CellGrid& grid, ShapeMatching& shape);
/// Whether a row is drawn to own a region: of every `stride` in a row one is, at a scattered place. Every
/// third row of a lattice of 12 is whole columns of it, and bent ten times as wrongly as every second or
/// fourth.
bool is_drawn(std::uint32_t row, std::uint32_t stride);
/// First sums over the regions. [model 2]
void sum_regions(const VectorColumn& positions, std::size_t begin, int threads, InstructionLevel level,
                 ShapeMatching& shape);
/// R_j of every region from last step's, by at most `iterations` of Newton's method: with k_enough_iterations
/// to single precision, with fewer as near as they come, with 0 exactly, in double. [model 2]
void solve_rotations(const VectorColumn& positions, std::size_t begin, int iterations, int threads,
                     InstructionLevel level, ShapeMatching& shape);
/// g − x of every particle. [TK eq. 7]
void compute_goals(const VectorColumn& positions, std::size_t begin, int threads, InstructionLevel level,
                   ShapeMatching& shape);

}  // namespace mallow

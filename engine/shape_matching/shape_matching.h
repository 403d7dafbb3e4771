#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "core/column.h"
#include "core/isa.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"
#include "shape_matching/shape_kernels.h"

namespace mallow {

/// The rigid motion that takes a group's reference shape nearest to where it is: x ≈ R x̄ + t.
struct RigidFrame {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation{0, 0, 0};
};

/// Shape matching of one group: its reference shape and the regions on it. Row i of every column is the i-th
/// particle of the group.
struct ShapeMatching {
  float region_radius = 0;  ///< [m]
  VectorColumn reference;   ///< x̄ relative to the group's centre [m]
  bool built = false;       ///< the regions belong to the reference shape

  NeighborLists regions;
  Column<float> weight, region_weight;    ///< w_i, W_j
  VectorColumn center;                    ///< c̄_j [m]
  std::array<Column<float>, 6> moment;    ///< B_j [m²]
  double total_moment = 0;                ///< trace of Σ x̄ x̄ᵀ / n [m²]
  std::array<Column<float>, 4> rotation;  ///< R_j as x y z w
  RigidFrame frame;
  Column<float> rows, sums;  ///< k_row floats a particle
  Column<std::uint8_t> undecided;
  VectorColumn pull;  ///< g − x [m]
  std::vector<std::array<double, 12>> partial;

  std::size_t bytes() const;
};

/// x̄ ← x of the rows [begin, end) of a store. Rotations start from none; regions are due to be built.
void update_reference(const VectorColumn& positions, std::size_t begin, std::size_t end,
                      ShapeMatching& shape);
/// Regions of the reference shape: lists, weights, centres, moments. Fast where the particles lie in cell
/// order, so that a region's rows lie near each other. `grid` is scratch.
void build_regions(int threads, InstructionLevel level, CellGrid& grid, ShapeMatching& shape);
/// First sums over the regions. [model 2]
void sum_regions(const VectorColumn& positions, std::size_t begin, int threads, InstructionLevel level,
                 ShapeMatching& shape);
/// R_j of every region from last step's. [model 2]
void solve_rotations(const VectorColumn& positions, std::size_t begin, int threads, InstructionLevel level,
                     ShapeMatching& shape);
/// g − x of every particle. [TK eq. 7]
void compute_goals(const VectorColumn& positions, std::size_t begin, int threads, InstructionLevel level,
                   ShapeMatching& shape);

}  // namespace mallow

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// Floats of a row: twelve sums, Σ e_j where regions differ, and padding, one cache line, so that a neighbour
/// costs one load and one add.
inline constexpr std::size_t k_row = 16;
inline constexpr std::size_t k_row_sums = 12;
/// Consecutive rows.
struct Run {
  std::uint32_t first, count;
};
/// Rows in the longest run that a table has a sum of, and how many lengths it can have.
inline constexpr std::uint32_t k_longest_run = 32;
inline constexpr std::uint32_t k_max_lengths = 16;
/// Lengths of the runs that a table of rows has sums of, ascending from 1: entry l rows + i of the table is
/// the sum of the length[l] rows from i on. Entries of one length lie together: lists of neighbouring rows
/// read neighbouring entries.
struct RunLengths {
  std::uint32_t length[k_max_lengths] = {1};
  std::uint32_t count = 1;
};

/// Entries of a list between the one whose row is asked for from memory and the one that is added: as much
/// time as memory takes.
inline constexpr std::uint32_t k_prefetch = 96;
/// Lists of the entries of a table of rows, behind each other in one array.
struct RegionLists {
  const std::uint32_t* begin;
  const std::uint32_t* count;
  const std::uint32_t* entries;  ///< and k_prefetch more, of any entries
  bool prefetch;                 ///< the table is larger than the caches near the core
};

/// The regions of one group: particle i is in the regions N_i, region j holds the particles N_j. Where every
/// particle owns a region the two are one list (model 2); with fewer owners every region is still whole, and
/// |N_i| counts the regions that are owned. Everything is relative to a rigid frame of
/// the group, x = R_g x̄ + t + u, so that what is summed and subtracted is as small as the deformation, not as
/// large as the body: a rigid motion gives u = 0, Q = 0 and goal = position exactly.
///
/// symbol  | column        | unit | eq.
/// x̄_i     | reference     | m    | relative to the group's centre
/// u_i     | (computed)    | m    | x_i − (R_g x̄_i + t)
/// w_i     | weight, 1/|N_i| | 1  | model 2; the group's mass cancels
/// W_j     | region_weight | 1    | Σ_{i∈N_j} w_i
/// c̄_j     | center        | m    | Σ w x̄ / W
/// B_j     | moment        | m²   | Σ w x̄ x̄ᵀ − W c̄ c̄ᵀ: xx yy zz yz xz xy
/// R_j     | rotation      | 1    | quaternion x y z w, last step's where a step starts
/// e_j     | elasticity    | 1    | (1 − α_j) times the stiffness factor of region j's owner, where some
/// differ:
///         |               |      | the goal of region j counts e_j times. Momentum is kept, as what a region
///         |               |      | does to its particles sums up to nothing. [model 2, section 7]
struct ShapeInput {
  RegionLists regions;      ///< per region: its particles
  RegionLists memberships;  ///< per particle: its regions; the same lists where every particle owns a region
  ConstVectors position;    ///< of the group's first particle on
  ConstVectors reference;
  const float* weight;
  const float* region_weight;
  ConstVectors center;
  const float* moment[6];
  const float* elasticity;     ///< null: 1 for all
  float frame_rotation[9];     ///< R_g, row by row
  float frame_translation[3];  ///< t
};

struct ShapeLanes {
  /// Rows of particles [begin, end), from `rows` on: w u x̄ᵀ (row by row), w u.
  void (*write_rows)(const ShapeInput&, std::size_t begin, std::size_t end, float* rows) noexcept;
  /// The table entries of the first `count` rows, those of one length `all` entries behind those of the one
  /// before. Reads longest length − 1 rows more: zero beyond the last.
  void (*sum_runs)(const float* rows, std::size_t count, const RunLengths& lengths, std::size_t all,
                   float* table) noexcept;
  /// sums row j, of region j: Σ_{i∈N_j} of rows, by a table of them.
  void (*sum_regions)(const ShapeInput&, std::size_t begin, std::size_t end, const float* table,
                      float* sums) noexcept;
  /// g_i − x_i = w_i (Σ (R_j − R_g) x̄_i + Σ (...)) − u_i, by a table of the rows of sums. [TK eq. 7] Where
  /// regions differ, w_i Σ e_j (goal_ij − x_i).
  void (*goals)(const ShapeInput&, std::size_t begin, std::size_t end, const float* table,
                Vectors pull) noexcept;
};
MALLOW_DECLARE_LEVELS(ShapeLanes, shape_lanes)

}  // namespace mallow

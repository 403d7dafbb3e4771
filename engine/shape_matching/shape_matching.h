#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "core/range_blocks.h"
#include "shape_matching/plastic.h"
#include "shape_matching/regions.h"
#include "shape_matching/rotation_lanes.h"
#include "shape_matching/run_tables.h"
#include "shape_matching/shape_lanes.h"

namespace mallow {

/// The rigid motion that takes a body's reference shape nearest to where it is: x ≈ R x̄ + t.
struct RigidFrame {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation{0, 0, 0};
};

/// What find_parts() told of a shape, so that it is not found again before the next lists of regions.
struct KeptParts {
  bool known = false;
  std::vector<std::uint32_t> of;  ///< as in Parts; empty where all are in one
  std::size_t count = 0, crumbs = 0;
};

/// Shape matching of one body: its reference shape and the regions on it. Particles are counted from the
/// body's first, regions by their owners in the order of particles: with a stride of 1 every particle owns a
/// region, and region j is that of particle j.
struct ShapeMatching {
  float region_radius = 0;  ///< [m]
  int region_stride = 1;    ///< every so many particles one owns a region; >= 1
  float spacing = 0;        ///< of the particles [m]; 0: not known
  bool flows = false;       ///< its regions have a plastic stretch
  VectorColumn reference;   ///< x̄ relative to a place in the body's middle [m]
  bool built = false;       ///< the regions belong to the reference shape

  TableLists regions;      ///< per region: its particles
  TableLists memberships;  ///< per particle: its regions; empty with a stride of 1, where `regions` says it
  double average_neighbors = 0;  ///< mean |N_i| of all particles, whatever the stride
  // A row a region.
  Column<float> region_weight;            ///< W_j
  VectorColumn center;                    ///< c̄_j [m]
  std::array<Column<float>, 6> moment;    ///< B_j [m²]
  std::array<Column<float>, 4> rotation;  ///< R_j as x y z w
  Column<float> elasticity;               ///< e_j; empty where it is the same for all
  Column<std::uint32_t> owners;           ///< particle of each region; empty with a stride of 1
  Column<float> sums;                     ///< k_row floats a region, and k_longest_run rows of zeros
  Column<std::uint8_t> undecided;
  PlasticColumns plastic;
  // A row a particle.
  Column<float> weight;  ///< w_i
  VectorColumn pull;     ///< g − x [m]
  /// Sums of consecutive rows: of particles for the first sums, then of regions for the second.
  Column<float> table;

  Eigen::Vector3d mean{0, 0, 0};  ///< of x̄ [m]; 0 until particles come or go
  double total_moment = 0;        ///< trace of Σ (x̄ − mean) (x̄ − mean)ᵀ / n [m²]
  RigidFrame frame;
  KeptParts parts;

  /// The particle whose region it is.
  std::size_t owner(std::size_t region) const { return region_stride == 1 ? region : owners[region]; }
  /// A particle of region j: the owner, or with a stride above 1 the first that the region's list names.
  std::size_t first_row(std::size_t region) const {
    return region_stride == 1 ? region : regions.entries[regions.begin[region]] % regions.rows;
  }
  /// A region of particle i: its own, or with a stride above 1 the first that its list names.
  std::size_t first_region(std::size_t i) const {
    return region_stride == 1 ? i : memberships.entries[memberships.begin[i]] % memberships.rows;
  }
  const TableLists& by_particle() const { return region_stride == 1 ? regions : memberships; }
  std::size_t bytes() const;
};

/// What lanes see of a shape whose particles are in the rows from `begin` on.
ShapeInput shape_input(const VectorColumn& positions, std::size_t begin, const ShapeMatching& shape);

/// Bodies whose shapes are matched together. Large ones take one phase after the other, each once over the
/// blocks of all of them. Small ones, of one block, take all phases one after the other while they are in the
/// caches: from phase to phase a thousand of them would be fetched anew, in pieces too small to be foreseen,
/// and cost twice what one body of as many particles does.
class MatchedBodies {
 public:
  void clear();
  /// One more body, whose particles are in the rows from `begin` on. Its regions are built, and stay as they
  /// are until clear(). rule: of a shape that flows.
  void add(ShapeMatching& shape, std::size_t begin, const FlowRule& rule = {});

  struct Body {
    ShapeMatching* shape;
    std::size_t begin;
    FlowRule rule;
    ShapeInput input = {};  ///< since the last sum_regions()
    /// Per region what reframed_region() makes of it, if asked for.
    std::vector<ReframedRegion>* reframed = nullptr;
  };
  float time_step = 0;  ///< in which regions flow; 0: nothing does [s]
  std::vector<Body> small, large;
  RangeBlocks particles, regions;  ///< of the large ones
  std::vector<std::array<double, 12>> partial;
};

/// R_j of the matrix in front of the sums row of a region, in double, which turns from its last rotation as
/// little as can be. scale: see polar_rotation(). Nothing where it is not finite: the rotation stays, for a
/// later step, and the goals will show that this one has none.
std::optional<Eigen::Quaterniond> solve_exactly(std::size_t region, double scale, ShapeMatching& shape);

/// solve_rotations() of some regions of a body that flows, in a step of `time_step`; 0: nothing flows.
void solve_plastic_regions(const MatchedBodies::Body& body, std::size_t begin, std::size_t end,
                           int iterations, InstructionLevel level, float time_step);

/// Sums, rotations and goals of the small bodies; the phases below are those of the large ones.
void match_small_bodies(const VectorColumn& positions, int iterations, const Execution& execution,
                        MatchedBodies& matched);
/// First sums over the regions. [model 2]
void sum_regions(const VectorColumn& positions, const Execution& execution, MatchedBodies& matched);
/// R_j of every region from last step's, by at most `iterations` of Newton's method: with k_enough_iterations
/// to single precision, with fewer as near as they come, with 0 exactly, in double. [model 2] Of bodies that
/// flow also S_j, for the next step.
void solve_rotations(int iterations, const Execution& execution, MatchedBodies& matched);
/// g − x of every particle. [TK eq. 7]
void compute_goals(const Execution& execution, MatchedBodies& matched);
/// All of these.
void match_shapes(const VectorColumn& positions, int iterations, const Execution& execution,
                  MatchedBodies& matched);

}  // namespace mallow

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "colliders/contact.h"
#include "core/column.h"
#include "core/execution.h"
#include "core/range_blocks.h"
#include "sph/kernel_functions.h"
#include "sph/sph_lanes.h"

namespace mallow {

/// A body that feels walls.
struct WalledBody {
  std::size_t begin, end;  ///< rows
  float reach;             ///< distance of a collider's surface beyond which it is not felt [m]
  float alpha;             ///< share of what SPH does that acts
  float mass;              ///< m [kg]
  const SphGroup* group;   ///< its constants
};

/// What colliders are to SPH: filled with the matter that meets them. Each part within σ of a particle is to
/// it the half space behind the plane that is nearest, so that neither density nor pressure ends at a wall.
///
/// symbol | here       | unit | what                                              | source
/// S      | share      | 1    | ∫ W over the half space                           | Koschier & Bender 2017
/// B      | gradient   | 1/m  | |∫ ∇W| of it, along its normal n                  |
/// a^wall | acceleration | m/s² | α (p_i/ρ_i B n + S/(1 − S) (a^SPH − (a^SPH·n) n)) |
///
/// Across, what is behind a wall has the particle's own pressure (Akinci et al. 2012). Along, it has the
/// gradient that the particle's neighbours show, 1 − S of all there would be: without, the fluid beside a
/// wall is held half and sinks, the rest goes round for ever, and a block floats a fifth too high.
struct Walls {
  bool any = false;  ///< some are near some particle
  /// By row of the particle store, 0 where no wall is near; read only where there is any.
  Column<float> share;              ///< S of all that are near
  VectorColumn acceleration;        ///< a^wall, part of a_ext [m/s²]
  std::vector<ColliderLoad> loads;  ///< what they get of it a second [N, N m]; empty where nobody asks

  // Scratch, by block of `bodies`.
  struct Wall {
    std::uint32_t row, collider;
    std::uint32_t before;   ///< the one before it of this row, counted from 1; 0: none
    float share, gradient;  ///< S and B, what other walls cover left out
    float slope;            ///< −dS/dd of it [1/m]; 0 with poly6
    float distance;         ///< of the particle from it [m]
    Vec3 normal;            ///< n
    float across = 0;       ///< with what it has pushed the particle across in this step [m/s²]
  };
  std::vector<WalledBody> bodies;
  RangeBlocks blocks;
  std::vector<std::vector<NearWall>> near;
  std::vector<std::vector<Wall>> walls;
  std::vector<ColliderLoad> partial_loads;  ///< by block, and in it by collider
  std::vector<ColliderLoad> rubbed;         ///< likewise, what their friction gave [N s]

  void release();
  std::size_t bytes() const;
};

/// positions, colliders -> walls of `bodies`, S of every row. The velocities are not used.
void find_walls(const VectorColumn& position, const VectorColumn& velocity,
                std::span<const PlacedCollider> colliders, DensityKernel kernel, float support_radius,
                const Execution& execution, Walls& walls);

/// What the pressure of walls follows from, by row of the store.
struct WallInput {
  const VectorColumn& position;
  const Column<float>& density;          ///< ρ [kg/m³]
  const VectorColumn& sph_acceleration;  ///< a^SPH [m/s²]
  Vec3 gravity;                          ///< [m/s²]
  const float* alpha;                    ///< null: that of each body, and a^SPH is not blended yet
  const std::uint16_t* pin;              ///< rows whose pin is not 0 give no load; null: all do
  bool all_loads;                        ///< of colliders that do not measure theirs too
};
/// Beside a push across of a wall, what its matter would add along it to what a particle gets from its
/// neighbours, of which it sees `share`, the S of all walls, too little.
/// Where its alpha is below 1 it gets at most what gravity would take along the wall, `weight` in units of
/// the same [m/s², or m/s of a step], as at rest it needs no more: a solid's stresses along a floor have a
/// sum that is not 0, and drove it.
Vec3 pushed_along(const Walls::Wall& wall, float alpha, float share, const Vec3& by_neighbors,
                  const Vec3& weight);
/// Velocity of the point of a collider that is at x, with what it carries along [m/s].
Vec3 velocity_at(const ContactSurface& surface, const Vec3& x);
/// What a collider gets of a particle of `mass` at x whose velocity it changed.
void add_load(float mass, const Vec3& change, const Vec3& x, const PlacedCollider& collider,
              ColliderLoad& load);
/// ρ, a^SPH -> a^wall and loads. A negative pressure counts as none: walls hold nothing back.
void press_walls(const WallInput& in, std::span<const PlacedCollider> colliders, const Execution& execution,
                 Walls& walls);

/// What friction of walls reads, by row of the store.
struct RubInput {
  const VectorColumn& position;
  const VectorColumn& before;  ///< v at the start of the step
  const std::uint16_t* pin;    ///< rows whose pin is not 0 do not rub; null: all do
  float time_step;             ///< Δt [s]
};
/// v' -> v' that the friction of what walls have pushed with has slowed, and loads: contact finds less to do
/// by as much as they pushed, and its friction with it. As there, it takes at most what slides, and leaves
/// what the step has turned round already. [model 2, section 4 A]
void rub_walls(const RubInput& in, std::span<const PlacedCollider> colliders, const Execution& execution,
               Walls& walls, VectorColumn& velocity);

}  // namespace mallow

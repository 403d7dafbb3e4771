#pragma once

#include <cstdint>
#include <vector>

#include "contact/point_lanes.h"
#include "core/box_tree.h"
#include "core/column.h"
#include "core/execution.h"
#include "core/range_blocks.h"

namespace mallow {

struct ShapeMatching;

/// What contact between bodies is measured by.
struct BodyContactStep {
  float time_step;  ///< Δt [s]
  float reach;      ///< pairs farther apart do not touch in a step [m]
  float max_push;   ///< speed at most at which bodies that overlap are pushed apart [m/s]
  /// Of calls with the same positions and bodies in one step the second and later ones. Where velocities have
  /// changed by no more than `slack` since the first, who is near is not looked for again. It changes no
  /// pair: who is near is a first guess, which velocities of now thin out.
  bool again = false;
  float slack = 0;  ///< 0 where there is one call in a step [m/s]
};

/// A body as contact sees it.
struct TouchingBody {
  std::size_t begin, end;      ///< rows
  std::uint32_t group;         ///< bodies of one group are parts of one and do not touch
  float spacing;               ///< h [m]
  float mass;                  ///< of a particle, m [kg]
  float friction;              ///< Coulomb's μ_f
  float adhesion;              ///< a [Pa]
  bool sleeps;                 ///< two that do are not looked at
  const ShapeMatching* shape;  ///< null: nothing says which way is out of it
};

/// Where particles are, and how they move: from the middle of some, none is faster than `spread`.
struct Moving {
  Aabb box;          ///< [m]
  Vec3 velocity;     ///< [m/s]
  float spread = 0;  ///< [m/s]
};

/// Blocks of rows that may come near one of another body in this step. All others are not looked at again.
struct NearBlocks {
  RangeBlocks blocks;
  struct Other {
    std::uint32_t block;
    float reach;  ///< pairs farther apart do not touch in this step [m]
  };
  std::vector<std::vector<Other>> others;  ///< per block, ascending

  // Scratch.
  std::vector<Moving> block_motion, body_motion;
  std::vector<Moving> found_motion;  ///< of blocks, by which all that was found, slack and all
  Vec3 mean_velocity;                ///< of bodies, where they were looked for [m/s]
  std::vector<Aabb> boxes;           ///< of bodies, as wide as they may reach
  BoxTree tree;                      ///< of these

  std::size_t bytes() const;
};

/// By how much more than they come by themselves two points may be pushed together in this step [m].
inline float pushed_together(const BodyContactStep& step) {
  return 0.25f * step.time_step * step.max_push;
}

/// A box, so much wider.
LaneBox lane_box(const Aabb& box, float reach);

/// velocities: predicted. The same for any number of threads. Returns whether it looked for them: not where
/// all that the call before found may stay.
bool find_near_blocks(const VectorColumn& positions, const VectorColumn& velocities,
                      const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                      const Execution& execution, NearBlocks& near);

}  // namespace mallow

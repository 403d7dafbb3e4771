#pragma once

#include "contact/near_blocks.h"

namespace mallow {

/// A particle near another body. In one piece, as pairs read it whole.
struct ContactPoint {
  Vec3 position;       ///< [m]
  Vec3 outward;        ///< N/|N|, which way out of its body it lies; 0 where nothing says it
  float depth;         ///< |N|, from the middle of its region to it [m]
  float inverse_mass;  ///< 1/m, 0 where it is pinned [1/kg]
  float friction;      ///< √μ_f
  float adhesion;      ///< √a [√Pa]
  float half_spacing;  ///< h/2 [m]
};

/// One point beside one of another body, seen from the first.
struct ContactPair {
  Vec3 normal;          ///< n, from the second body to the first
  float target;         ///< t, what their velocity along n must reach [m/s]
  float sticks;         ///< impulse by which they may still be held together in this step [N s]
  std::uint32_t other;  ///< the second
};

/// A velocity, and how many pairs of its point push.
struct ContactVelocity {
  Vec3 velocity;  ///< [m/s]
  float pushes;
};

/// Points of one block that have pairs, and these, one point's behind the other's.
struct BlockPairs {
  struct Touching {
    std::uint32_t point, count;
  };
  std::vector<Touching> points;
  std::vector<ContactPair> pairs;
  std::vector<Vec3> got;  ///< from each pair in this step [N s]; empty where nobody asks
};

/// What a step of contact between bodies needs and finds.
struct ContactPairs {
  NearBlocks near;
  std::vector<BlockPairs> blocks;  ///< those of `near`
  bool keep_impulses = false;      ///< somebody asks what pairs gave
  // By point.
  std::vector<ContactPoint> points;
  std::vector<ContactVelocity> velocity, next_velocity;

  // Scratch.
  VectorColumn positions;  ///< of the points, for lanes
  std::vector<float> partial_excess;

  std::size_t bytes() const;
};

/// positions, predicted velocities -> pairs, with their normals and targets. [model 2, section 4 C]
/// pin: null where nothing is pinned. Returns whether there is any.
bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs);

}  // namespace mallow

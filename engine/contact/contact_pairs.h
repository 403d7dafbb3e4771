#pragma once

#include "contact/near_bodies.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"

namespace mallow {

/// What contact between bodies is measured by.
struct BodyContactStep {
  float time_step;  ///< Δt [s]
  float reach;      ///< pairs farther apart do not touch in a step [m]
  float max_push;   ///< speed at most at which bodies that overlap are pushed apart [m/s]
};

/// A particle near another body. In one piece, as pairs read it whole.
struct ContactPoint {
  Vec3 position;       ///< [m]
  Vec3 outward;        ///< N/|N|, which way out of its body it lies; 0 where nothing says it
  float depth;         ///< |N|, from the middle of its region to it [m]
  float inverse_mass;  ///< 1/m, 0 where it is pinned [1/kg]
  float friction;      ///< √μ_f
};

/// One point beside one of another body, seen from the first.
struct ContactPair {
  Vec3 normal;          ///< n, from the second body to the first
  float target;         ///< t, what their velocity along n must reach [m/s]
  std::uint32_t other;  ///< the second
};

/// A velocity, and how many pairs of its point push.
struct ContactVelocity {
  Vec3 velocity;  ///< [m/s]
  float pushes;
};

/// What a step of contact between bodies needs and finds. Points are in the order of a cell grid of theirs.
struct ContactPairs {
  NearBodies near;
  CellGrid grid;
  std::vector<ContactPair> pairs;  ///< one behind the other, by their first point
  Column<std::uint32_t> first;     ///< per point its first pair, and one more
  Column<std::uint32_t> touching;  ///< points with a pair
  // By point.
  Column<std::uint32_t> row, group;
  Column<float> half_spacing, half_reach;  ///< h/2, and that with what it may move in this step [m]
  std::vector<ContactPoint> points;
  std::vector<ContactVelocity> velocity, next_velocity;

  // Scratch.
  VectorColumn positions;
  NeighborLists lists;
  std::vector<std::vector<ContactPair>> found;  ///< per block of points
  std::vector<Vec3> partial_velocity;
  std::vector<float> partial_speed, partial_excess;

  std::size_t bytes() const;
};

/// positions, predicted velocities -> pairs, with their normals and targets. [model 2, section 4 C]
/// pin: null where nothing is pinned. Returns whether there is any.
bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs);

}  // namespace mallow

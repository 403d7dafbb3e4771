#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "colliders/collider_lanes.h"
#include "core/column.h"
#include "core/contact_sums.h"
#include "mallow/collider.h"
#include "mallow/instruction_level.h"

namespace mallow {

/// A collider as a step meets it.
struct PlacedCollider {
  struct Part {
    ShapeNumbers numbers;
    const ColliderLanes* lanes;
  };
  /// One of the equal times that a step is cut into in which it turns far: where it stands at their start, as
  /// `surface` has it, and how it is turned at their end.
  struct Piece {
    float translation[3], rotation[9], turned[9];
  };
  ContactSurface surface;
  std::vector<Part> parts;
  bool measures_load;
  std::vector<Piece> pieces;  ///< of its turn; none where a step is met as a whole
  float piece_spin[9];        ///< Ω of each of them
  float radius;               ///< no point of it is farther from its origin; of what has pieces [m]
};

/// Colliders that turn no farther in a step are met as one motion from its start to its end. [rad] A particle
/// goes a straight way in the frame of the collider, and passes at r cos(angle/2) from the axis where it
/// should stay at r: 0.3% nearer here. Those that turn farther are met in as many pieces as turn no farther.
inline constexpr double k_most_turn = 0.15;

/// Colliders as they stand at the start of a step of `time_step` [s], relative to `origin`. Keeps the memory
/// that `placed` has.
void place_colliders(std::span<const Collider> colliders, const Vec3& origin, float time_step,
                     InstructionLevel level, std::vector<PlacedCollider>& placed);

/// Whether any measures what particles do to it.
bool any_measures_load(std::span<const PlacedCollider> colliders);

/// Rows [begin, end) of the store, at most k_block of them, that meet obstacles with new velocities.
struct ContactBlock {
  std::size_t begin, end;
  const VectorColumn& position;
  const VectorColumn& before;  ///< v at the start of the step
  const std::uint16_t* pin;    ///< rows whose pin is not 0 meet nothing; null: all do
  BlockBounds bounds;          ///< of the positions and of the velocities before contact
};

/// v of every row becomes what contact with each collider in order makes of it, and with the parts of one in
/// order. Only rows within reach of a part are resolved, and only parts within reach of the block are looked
/// at: a surface farther than contact_offset + Δt |v − u| leaves v alone, for |n| = 1. loads: where given,
/// one a collider, to which what those that measure it got is added, for a mass of 1. touches: where given,
/// one a collider, to which what the rows got from it is added, for a mass of 1. [model 2, section 4 A]
/// What meets a collider that turns by more than k_most_turn meets it in each piece of its turn in order,
/// where it is by then, and gets the mean of the velocities that it had in them.
void resolve_contacts(const ContactBlock& block, std::span<const PlacedCollider> colliders,
                      const ContactStep& step, VectorColumn& velocity, std::span<ColliderLoad> loads,
                      std::span<ContactSums> touches = {});

/// A part of a collider that a particle is near.
struct NearWall {
  std::uint32_t row, collider;
  float distance;  ///< [m]
  Vec3 normal;     ///< away from it
};
/// The parts within `reach` [m] of the rows [begin, end) of the store, at most k_block of them: by collider,
/// part and row.
void find_near_walls(const VectorColumn& position, const VectorColumn& velocity, std::size_t begin,
                     std::size_t end, std::span<const PlacedCollider> colliders, float reach,
                     std::vector<NearWall>& near);

}  // namespace mallow

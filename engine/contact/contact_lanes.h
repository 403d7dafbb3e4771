#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// A pair counts only where its points lie above each other: how far apart across n, in d0.
inline constexpr float k_across = 0.75f;

struct LaneBox {
  float low[3], high[3];  ///< [m]
};

/// What a step asks of pairs.
struct PairStep {
  float time_step;  ///< Δt [s]
  float max_push;   ///< speed at most at which what overlaps is pushed apart [m/s]
  float pushed;     ///< by how much more than they come by themselves two points may be pushed together [m]
};

/// Points as lanes read them, in rows of floats: those of ContactPoint and of ContactVelocity.
struct ContactRows {
  const float* points;
  const float* velocities;
};

/// Points that are tried with others, k_cluster more than there are. Two may touch in this step only where r²
/// <= (across_i + across_j)² + (along_i + along_j)²: so far apart may they be across n, and along it each
/// comes nearer by no more than its own way.
struct MeetingPoints {
  std::uint32_t* name;
  Vectors position;       ///< [m]
  float *along, *across;  ///< [m]
};

/// Pairs of points, each seen from the first.
struct PairColumns {
  std::uint32_t *own, *other;
  Vectors normal;   ///< n, from the other to this
  float* target;    ///< t, what their velocity along n must reach [m/s]
  float* sticks;    ///< impulse by which they may still be held together in this step [N s]
  float* friction;  ///< √(μ_i μ_j)
};

struct ContactLanes {
  /// Of the points [begin, end) those in any of the boxes, in order; returns how many. out: room for all and
  /// k_cluster more.
  std::size_t (*in_boxes)(const ConstVectors&, std::size_t begin, std::size_t end, const LaneBox*,
                          std::size_t boxes, std::uint32_t* out) noexcept;
  /// The same of one box, where boxes around each k_cluster points from `begin` on are known: their corners.
  std::size_t (*in_box)(const ConstVectors&, std::size_t begin, std::size_t end, const LaneBox&,
                        const ConstVectors& low, const ConstVectors& high, std::uint32_t* out) noexcept;
  /// n names of points -> all else that they are tried by. velocity: of a frame in which they move little.
  void (*gather)(const ContactRows&, const PairStep&, const float* velocity, std::size_t n,
                 const MeetingPoints&) noexcept;
  /// The names of those of n points that point `i` of others may touch, in order; returns how many. out: room
  /// for n + k_cluster.
  std::size_t (*meeting)(const MeetingPoints& own, std::size_t i, const MeetingPoints& of, std::size_t n,
                         std::uint32_t* out) noexcept;
  /// Adds those of n pairs of points (own and other, k_cluster more of room) that may touch in this step
  /// behind the `count` that are there, in order; returns how many there are then. [model 2, section 4 C]
  std::size_t (*add_pairs)(const ContactRows&, const PairStep&, std::uint32_t* own, std::uint32_t* other,
                           std::size_t n, const PairColumns&, std::size_t count) noexcept;
  /// Of n pairs, and k_cluster more of room: 1 for each that comes nearer than it may, or sticks, else 0.
  /// Returns the most by which the velocity of one misses its target.
  float (*acting)(const float* velocities, const PairColumns&, std::size_t n, float* acts) noexcept;
  /// Impulses on the first point of each pair, a row of four: three, and nothing [N s]; 0 where none acts.
  /// velocities: with the shares of this round.
  void (*impulses)(const float* velocities, const PairColumns&, std::size_t n, const float* acts,
                   float* rows) noexcept;
};
MALLOW_DECLARE_LEVELS(ContactLanes, contact_lanes)

}  // namespace mallow

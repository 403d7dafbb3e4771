#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// A pair counts only where its points lie above each other: how far apart across n, in d0.
inline constexpr float k_across = 0.75f;

/// What a step asks of pairs.
struct PairStep {
  float time_step;  ///< Δt [s]
  float max_push;   ///< speed at most at which what overlaps is pushed apart [m/s]
  float pushed;     ///< by how much more than they come by themselves two points may be pushed together [m]
};

/// Points as lanes read them: see PointColumns.
struct ContactRows {
  const float *place, *outward, *matter;
  const float* velocity;  ///< [m/s], and 1/m times how many of its pairs act in a round [kg⁻¹]
};

/// Pairs of points, each seen from the first.
struct PairColumns {
  std::uint32_t *own, *other;
  Vectors normal;   ///< n, from the other to this
  float* target;    ///< t, what their velocity along n must reach [m/s]
  float* sticks;    ///< impulse by which they may still be held together in this step [N s]
  float* friction;  ///< √(μ_i μ_j)
};

/// What pairs do in a round.
struct RoundColumns {
  float* acts;      ///< 1 for each that comes nearer than it may, or sticks, else 0
  Vectors closing;  ///< v_i − v_j [m/s]
  /// Of its points, where it acts: see ContactRows::velocity. The first has room for three more.
  float *own_share, *other_share;
  float* impulses;  ///< on the first point, rows of four: three, and nothing [N s]
};

/// A point that has pairs: those in which it is the first follow each other, the others are listed.
struct TouchingPoint {
  std::uint32_t point;
  std::uint32_t first_pair, end_pair;
  std::uint32_t end_other;  ///< its list begins where that of the point before ends
};
struct TouchingPoints {
  const TouchingPoint* points;
  std::size_t count;
  const std::uint32_t* others;
};

struct ContactLanes {
  /// Of n pairs of points (own and other, k_cluster more of room) those that may touch in this step, in
  /// order; returns how many. [model 2, section 4 C]
  std::size_t (*add_pairs)(const ContactRows&, const PairStep&, std::uint32_t* own, std::uint32_t* other,
                           std::size_t n, const PairColumns&) noexcept;
  /// Of n points those in [begin, end), in order, counted from `begin`, and which of the n they are, counted
  /// from `first`; returns how many. which, found: room for all and k_cluster more.
  std::size_t (*find_points)(const std::uint32_t* points, std::size_t n, std::uint32_t begin,
                             std::uint32_t end, std::uint32_t first, std::uint32_t* which,
                             std::uint32_t* found) noexcept;
  /// Which of n pairs act, and how they close. Of all columns there is room for k_cluster more pairs. Returns
  /// the most by which the velocity of one misses its target.
  float (*acting)(const float* velocities, const PairColumns&, std::size_t n, const RoundColumns&) noexcept;
  /// Points share their masses between their pairs that act. pairs: of all blocks.
  void (*share)(const TouchingPoints&, const float* matter, const RoundColumns& pairs,
                float* velocities) noexcept;
  /// Impulses of n pairs; 0 where none acts.
  void (*impulses)(const PairColumns&, std::size_t n, const RoundColumns&) noexcept;
  /// Gives points those of their pairs. impulses: of all blocks.
  void (*push)(const TouchingPoints&, const float* matter, const float* impulses, float* velocities) noexcept;
};
MALLOW_DECLARE_LEVELS(ContactLanes, contact_lanes)

}  // namespace mallow

#pragma once

#include "contact/point_lanes.h"

namespace mallow {

/// A pair counts only where its points lie above each other: how far apart across n, in d0.
inline constexpr float k_across = 0.75f;

/// Pairs of which a word of bits tells something.
inline constexpr std::size_t k_word = 64;

/// What a step asks of pairs.
struct PairStep {
  float time_step;  ///< Δt [s]
  float max_push;   ///< speed at most at which what overlaps is pushed apart [m/s]
  float pushed;     ///< by how much more than they come by themselves two points may be pushed together [m]
};

/// Points as lanes read them: see PointColumns.
struct ContactRows {
  const float *place, *outward, *matter;
  const float* velocity;  ///< [m/s], and nothing
};

/// Pairs of points, each seen from the first.
struct PairColumns {
  std::uint32_t *own, *other;
  Vectors normal;   ///< n, from the other to this
  float* target;    ///< t, what their velocity along n must reach [m/s]
  float* sticks;    ///< impulse by which they may still be held together in this step [N s]
  float* friction;  ///< √(μ_i μ_j)
};

/// What pairs of a block do in a round.
struct RoundColumns {
  std::uint64_t* acts;  ///< a bit for each pair that comes nearer than it may, or sticks
  Vectors closing;      ///< v_i − v_j [m/s]
  float* impulses;      ///< on the first point of those that act, rows of four: three, and 0 [N s]
};

/// Pairs [begin, end) of a block, and one point of each.
struct PointPairs {
  const std::uint32_t* points;
  const std::uint64_t* acts;
  const float* impulses;  ///< see RoundColumns
  std::uint32_t begin, end;
};
/// The points of a block: those pairs in which they are the first, and pairs of earlier blocks with its body,
/// in order, in some of which they are the second.
struct TouchingPoints {
  std::uint32_t begin, end;
  PointPairs own;
  const PointPairs* earlier;
  std::size_t earlier_count;
};

struct ContactLanes {
  /// Of n pairs of points (own and other, k_cluster more of room) those that may touch in this step, in
  /// order; returns how many. [model 2, section 4 C]
  std::size_t (*add_pairs)(const ContactRows&, const PairStep&, std::uint32_t* own, std::uint32_t* other,
                           std::size_t n, const PairColumns&) noexcept;
  /// Which of n pairs act, and how they close; of closing there is room for k_cluster more. Returns the most
  /// by which the velocity of one misses its target.
  float (*acting)(const float* velocities, const PairColumns&, std::size_t n, const RoundColumns&) noexcept;
  /// Points of a block share their masses between their pairs that act. shares: 1/m times how many do [kg⁻¹].
  /// Returns a bit for each few of the block in which one has any.
  std::uint32_t (*share)(const TouchingPoints&, const float* inverse_mass, float* shares) noexcept;
  /// Impulses of those of n pairs that act.
  void (*impulses)(const PairColumns&, std::size_t n, const float* shares, const RoundColumns&) noexcept;
  /// Gives points of a block those of their pairs. acting: what share() returned.
  void (*push)(const TouchingPoints&, std::uint32_t acting, const float* inverse_mass, const float* shares,
               float* velocities) noexcept;
};
MALLOW_DECLARE_LEVELS(ContactLanes, contact_lanes)

}  // namespace mallow

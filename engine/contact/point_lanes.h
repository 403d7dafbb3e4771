#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// Of a block.
inline constexpr std::size_t k_most_points = 256;

struct LaneBox {
  float low[3], high[3];  ///< [m]
};

/// Where particles are, and how they move: from the middle of some, none is faster than `spread`.
struct LaneMotion {
  float low[3], high[3];  ///< [m]
  float velocity[3];      ///< [m/s]
  float spread;           ///< [m/s]
};
/// The same of every k_cluster points, a few of them.
struct FewColumns {
  Vectors low, high, velocity;
  float* spread;
};

/// What is known of the particles of a block, each column from the first row of the block on.
struct BlockColumns {
  ConstVectors position;
  ConstVectors reference, center;  ///< null: `outward` says what they say
  const float* rotation[4];        ///< x y z w, of the region of each
  ConstVectors outward;            ///< N; null: 0
  const std::uint16_t* pin;        ///< null: none is pinned
  float half_spacing, inverse_mass, friction, adhesion;
};

/// Points as lanes read them: in rows of four floats, and positions by themselves.
struct PointColumns {
  Vectors position;     ///< [m]
  float* place;         ///< position [m], h/2 [m]
  float* outward;       ///< N/|N|, which way out of its body it lies, 0 where nothing says it; |N| [m]
  float* matter;        ///< 1/m [kg⁻¹], 0 where it is pinned; √μ_f, √a [√Pa]; nothing
  float* inverse_mass;  ///< the first of these by itself
};

/// How near each other points of two fews are that may touch in this step.
struct FewReach {
  float time_step;      ///< Δt [s]
  float across, along;  ///< across n, and along it but for their own ways [m]
  float most;           ///< farther apart nothing touches [m]
};

/// Room that lanes take for the points of so many fews.
constexpr std::size_t room_of(std::size_t fews) {
  return k_cluster * (fews + 1);
}

/// A few of a block, and where in a list those near it end; they begin where those of the one before end.
struct OwnFew {
  std::uint32_t few, end;
};

/// Of particles near other bodies: where they are, how they move, and which are near each other.
struct PointLanes {
  /// How the particles [begin, end) move. What is no number is left for later phases to find: it counts as no
  /// motion here.
  void (*motion)(const ConstVectors& positions, const ConstVectors& velocities, std::size_t begin,
                 std::size_t end, LaneMotion&) noexcept;
  /// n particles of a block -> its points from `first` on, whole fews of them: behind the last are some that
  /// are nowhere.
  void (*place)(const BlockColumns&, std::size_t n, std::size_t first, const PointColumns&,
                const FewColumns&) noexcept;
  /// The same for velocities. rows: of four floats, three and 0.
  void (*set_velocities)(const ConstVectors&, std::size_t n, std::size_t first, float* rows,
                         const FewColumns&) noexcept;
  /// The reverse: n points from `first` on -> velocities, each column from the block's first row on.
  void (*get_velocities)(const float* rows, std::size_t n, std::size_t first, const Vectors&) noexcept;
  /// A bit for each of the fews [begin, end) of a block that meets a box.
  std::uint32_t (*fews_in_box)(const FewColumns&, std::size_t begin, std::size_t end,
                               const LaneBox&) noexcept;
  /// The same fews, and which they are; returns how many. few, list: room for all and k_cluster more.
  std::size_t (*list_fews)(const FewColumns&, std::size_t begin, std::size_t end, const LaneBox&,
                           std::uint32_t* few, const FewColumns& list) noexcept;
  /// For each few of a block that has a bit, counted from `begin`, those of a list of n fews that it may
  /// touch, in order and behind the `count` that are there, and the squares of how near points of the two are
  /// that do. own: those that have any; returns how many. near, squares: room for all, and k_cluster more.
  std::size_t (*near_fews)(const FewColumns&, std::size_t begin, std::uint32_t bits, const FewReach&,
                           const FewColumns& list, const std::uint32_t* few, std::size_t n,
                           std::uint32_t count, std::uint32_t* near, float* squares, OwnFew* own) noexcept;
  /// Pairs of points of n fews and those near them that are so near, few by few in the order of its points
  /// and then of the others; returns how many. scratch: room for k_cluster times room_of(what is near one),
  /// own_points, other_points: for k_cluster times room_of() of what is near each.
  std::size_t (*near_points)(const ConstVectors& positions, const FewColumns&, const OwnFew*, std::size_t n,
                             const std::uint32_t* near, const float* squares, std::uint32_t* scratch,
                             std::uint32_t* own_points, std::uint32_t* other_points) noexcept;
};
MALLOW_DECLARE_LEVELS(PointLanes, point_lanes)

}  // namespace mallow

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// A pair counts only where its points lie above each other: how far apart across n, in d0.
inline constexpr float k_across = 0.75f;

/// Points that another one is tried with. They touch it only where r² <= across² + (along + way)²: across is
/// how far apart they may be across n, and along it each comes nearer by no more than its own way.
struct MeetingPoints {
  const std::uint32_t* name;
  ConstVectors position;
  const float* along;  ///< d0, and how far it may come [m]
};

struct MeetingLanes {
  /// Of the points [begin, end) those in the box from `low` to `high`, in order; returns how many. out: room
  /// for all and k_cluster more.
  std::size_t (*in_box)(const ConstVectors&, std::size_t begin, std::size_t end, const float* low,
                        const float* high, std::uint32_t* out) noexcept;
  /// Of n points those that another one may touch in this step, in order; returns how many. out: room for n +
  /// k_cluster.
  std::size_t (*meeting)(const MeetingPoints&, std::size_t n, const float* at, float way, float across,
                         std::uint32_t* out) noexcept;
};
MALLOW_DECLARE_LEVELS(MeetingLanes, meeting_lanes)

}  // namespace mallow

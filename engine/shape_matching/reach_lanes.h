#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "shape_matching/shape_lanes.h"

namespace mallow {

/// Points sorted as PillarOrder sorts them, by their places along the pillars and across.
struct ReachInput {
  const float* along;
  const float* across[2];
  float squared_radius;
};

/// What of a pillar may be in reach of a point: sorted points [first, end), none of which is in reach where
/// it is farther along than `reach`.
struct ReachPillar {
  std::uint32_t first, end;
  float reach;  ///< [m]
};

struct ReachLanes {
  /// Writes the runs of sorted points in these pillars that are within the radius of sorted point s,
  /// ascending and apart from each other; returns how many. Moves the pillars' `first` behind what is out of
  /// reach of s and of all points farther along than it. runs: room for half as many as pillars and points
  /// together, and one. members: becomes how many points the runs hold.
  std::size_t (*runs_in_reach)(const ReachInput&, std::size_t s, ReachPillar* pillars, std::size_t count,
                               Run* runs, std::uint32_t& members) noexcept;
};
MALLOW_DECLARE_LEVELS(ReachLanes, reach_lanes)

}  // namespace mallow

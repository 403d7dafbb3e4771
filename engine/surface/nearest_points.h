#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/threads.h"
#include "mallow/export.h"
#include "mallow/vec3.h"

namespace mallow {

/// Which of some points is nearest to another one.
struct NearestPoint {
  float distance;       ///< [m]
  std::uint32_t index;  ///< of the nearest
};

/// For each of `points` the nearest of `others`: the same for any number of threads. Both finite; others: at
/// least one. spacing: a typical distance of theirs [m], > 0; it sets how fast this is, which is best where
/// points are a few spacings from the nearest at most.
MALLOW_EXPORT std::vector<NearestPoint> find_nearest(std::span<const Vec3> points,
                                                     std::span<const Vec3> others, float spacing,
                                                     const Threads& threads);
/// The `count` nearest, >= 1, or as many as there are: those of each point in a row, the nearest first, of
/// two at one distance that of the lower index.
MALLOW_EXPORT std::vector<NearestPoint> find_several_nearest(std::span<const Vec3> points,
                                                             std::span<const Vec3> others, std::size_t count,
                                                             float spacing, const Threads& threads);

}  // namespace mallow

#pragma once

#include <span>
#include <vector>

#include "mallow/vec3.h"

/// Numbers that say how a body lies, and how such a number behaves over time. All spans hold at least one
/// value.
namespace mallow::bench {

/// Value below which a share of the points' heights z lies [m]; share in [0, 1], 0 gives the lowest one.
double height_quantile(std::span<const Vec3> positions, double share);

/// Height of an upright, evenly filled column whose heights spread as those of the points: √12 standard
/// deviations of z [m]. A cube has the same one, its side, however it is tipped.
double column_height(std::span<const Vec3> positions);

/// Root mean square of the horizontal distance from the points' middle [m]. A cube has the same one however
/// it is tipped.
double horizontal_spread(std::span<const Vec3> positions);

/// Root mean square distance of points from the rigid motion of `reference` that comes nearest to them [m].
/// Both in the same order; at least three points.
double distance_to_rigid_motion(std::span<const Vec3> reference, std::span<const Vec3> positions);

/// Standard deviation of the top of the points over the columns of a horizontal grid with cells of side
/// `cell` [m], columns without points left out [m].
double unevenness(std::span<const Vec3> positions, double cell);

double lowest(std::span<const double> curve);
double highest(std::span<const double> curve);
/// The last `share` of a curve, in (0, 1], and its mean.
std::span<const double> last_of(std::span<const double> curve, double share);
double mean_of_last(std::span<const double> curve, double share);

}  // namespace mallow::bench

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mallow/vec3.h"

namespace mallow::bench {

/// Link radius in spacings that tells points that touch from points that do not: between the second
/// neighbours of a cubic lattice (√2) and the third (√3). What was sampled as one body is one part at any
/// jitter that is in use, and a gap of 0.6 spacings between particles of that width parts it.
inline constexpr double k_touching = 1.6;

/// Sizes of the parts that points fall into, largest first. Two points are in one part where a chain of
/// points joins them in which no step is longer than `link_radius` [m], > 0. positions: finite.
std::vector<std::size_t> connected_parts(std::span<const Vec3> positions, float link_radius, int threads);

/// Share of all points that are in the largest part. mallow::count_parts() tells how many are no crumbs.
double largest_share(std::span<const std::size_t> sizes);

}  // namespace mallow::bench

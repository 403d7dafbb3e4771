#pragma once

#include "mallow/vec3.h"

/// Signed distances, negative inside, from which implicit shapes are put together. All have slope 1 at most,
/// and so have their joints: what is built of them may be searched with steps as long as the distance.
namespace mallow {

float sphere_distance(const Vec3& x, const Vec3& center, float radius);

/// A box with half sides `half`, whose edges and corners are rounded off with radius `rounding` <= the
/// smallest of them.
float rounded_box_distance(const Vec3& x, const Vec3& center, const Vec3& half, float rounding);

/// All points within `radius` of the segment from a to b. Valid where a != b.
float capsule_distance(const Vec3& x, const Vec3& a, const Vec3& b, float radius);

/// An axis-aligned ellipsoid; exact to 1e-5 of its largest radius.
float ellipsoid_distance(const Vec3& x, const Vec3& center, const Vec3& radii);

/// What lies in either; the seam is filled over a width of `blend` > 0.
float smooth_union(float a, float b, float blend);

/// What lies in a and not in b; the rim is rounded off over a width of `blend` > 0.
float smooth_subtraction(float a, float b, float blend);

/// What lies in both; the rim is rounded off over a width of `blend` > 0.
float smooth_intersection(float a, float b, float blend);

}  // namespace mallow

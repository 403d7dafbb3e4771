#pragma once

#include <optional>

#include "view/camera.h"
#include "view/frame.h"

namespace mallow::view {

/// Where a ray first meets what a frame draws of bodies: triangles, or balls.
std::optional<Vec3> pick(const Frame& frame, const Ray& ray);
/// Where a ray meets the plane through a point across the view, which the mouse drags along.
Vec3 on_plane(const Ray& ray, const Vec3& point, const Vec3& forward);

}  // namespace mallow::view

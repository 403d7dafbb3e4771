#include "sph/held_walls.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Up to which distance of a wall, in spacings, a particle is in the layer beside it, and over which way it
/// comes in: layers of a lattice at rest are at 0.5 and 1.5.
constexpr float k_layer_end = 1.25f, k_layer_fade = 0.5f;
/// Least distance of a layer from its wall in spacings, half of that at rest.
constexpr float k_least_distance = 0.25f;

/// Share of a particle at d spacings from a wall that is in the layer beside it.
float share_beside(float d) {
  return std::clamp((k_layer_end - d) / k_layer_fade, 0.0f, 1.0f);
}

Vec3 held_by(const Walls::Wall& wall, const HeldBody& body, const HoldInput& in,
             const ContactSurface& surface, const Vec3& v) {
  const std::uint32_t row = wall.row;
  const float h = body.spacing, d = std::max((wall.distance + body.inward) / h, k_least_distance);
  const float beside = share_beside(d);
  if (!(beside > 0 && wall.share > 0)) return Vec3(0, 0, 0);
  const Vec3 x = in.position.get(row);
  Vec3 w = v - velocity_at(surface, x - wall.distance * wall.normal);
  if (surface.carries) w -= Vec3(surface.along);
  w -= w.dot(wall.normal) * wall.normal;
  const float speed = w.norm();
  if (!(speed > 0)) return Vec3(0, 0, 0);
  const float mu = in.viscosity ? in.viscosity[row] : body.viscosity;
  // ρ h³ = m.
  const float drag = -std::expm1(-beside * mu * in.time_step / body.mass * h / d);
  const float most = in.time_step * (surface.friction * std::max(wall.across, 0.0f) +
                                     beside * body.adhesion * h * h / body.mass);
  return -std::min(drag, most / speed) * w;
}

}  // namespace

void hold_at_walls(const HoldInput& in, const HeldBody& body, std::span<const PlacedCollider> colliders,
                   const Execution& execution, Walls& walls, VectorColumn& velocity) {
  const std::size_t count = walls.loads.size(), first = walls.blocks.first[body.number];
  const auto hold = [&](std::size_t number) {
    for (Walls::Wall& wall : walls.walls[number]) {
      if ((in.pin && in.pin[wall.row] != 0) || (in.alpha && in.alpha[wall.row] < 1)) continue;
      const PlacedCollider& collider = colliders[wall.collider];
      const Vec3 v = velocity.get(wall.row), change = held_by(wall, body, in, collider.surface, v);
      velocity.set(wall.row, v + change);
      wall.across = 0;
      if (count > 0)
        add_load(body.mass, change, in.position.get(wall.row), collider,
                 walls.rubbed[number * count + wall.collider]);
    }
  };
  parallel_for(
      execution.threads, walls.blocks.first[body.number + 1] - first,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) hold(first + k);
      },
      1);
}

}  // namespace mallow

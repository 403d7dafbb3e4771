#pragma once

#include <optional>

#include "render/bodies.h"
#include "render/obstacles.h"
#include "render/sampling.h"
#include "render/studio.h"

namespace mallow::render {

/// What a ray of the camera sees.
struct Surfel {
  Vec3 position{0, 0, 0};
  Vec3 outside{0, 0, 0};  ///< where rays that leave the surface start
  Vec3 normal{0, 0, 0};
  Vec3 albedo{0, 0, 0};
  float distance = k_far;  ///< from the eye
  float fade = 0;          ///< share of the backdrop in what is seen
  Look look = Look::none;
  std::uint32_t shape = 0;  ///< of an obstacle
  Obstacles::Veil veil{};

  bool same_object(const Surfel& other) const { return look == other.look && shape == other.shape; }
};

/// Bodies, obstacles, floor and studio, and the light between them.
class World {
 public:
  World(const Bodies& bodies, std::span<const Collider> colliders, const Camera& camera);

  Surfel look(const Ray& ray) const;
  /// One ray to the key light and one into the hemisphere for every pair of points of the unit disc.
  Light gather(const Surfel& at, std::span<const Point2> key, std::span<const Point2> hemisphere) const;
  /// Light from `at` towards the eye that sent `ray`.
  Vec3 color(const Ray& ray, const Surfel& at, const Light& light) const;

 private:
  float key_seen(const Surfel& at, const Vec3& to_light) const;
  Vec3 incoming(const Ray& ray) const;
  std::optional<float> floor_hit(const Ray& ray) const;
  Vec3 to_key(const Point2& disc) const;

  const Bodies& bodies_;
  Obstacles obstacles_;
  Studio studio_;
  Tangents key_tangents_;
  float epsilon_;  // distance from a surface at which rays start [m]
};

}  // namespace mallow::render

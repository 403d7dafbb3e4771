#pragma once

#include <optional>
#include <span>

#include "render/bodies.h"
#include "render/environment.h"
#include "render/finishes.h"
#include "render/obstacles.h"
#include "render/sampling.h"

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

/// Bodies, obstacles, floor and sky, and the light between them.
class World {
 public:
  World(const Bodies& bodies, const Obstacles& obstacles, const Environment& environment,
        const Camera& camera);

  /// What holds everything but the floor; left out where a wall has no bounds, empty where nothing is there.
  const std::optional<Aabb>& contents() const { return contents_; }
  Surfel look(const Ray& ray) const;
  /// The same for up to k_batch rays that go about the same way.
  void look(std::span<const Ray> rays, std::span<Surfel* const> seen) const;
  /// The same where a ray passes the contents.
  Surfel look_past(const Ray& ray) const;
  /// Takes a sample of the key light, and of what comes from all around less Environment::ambient(), at up
  /// to k_batch surfels, each through its own point of the unit disc.
  void sample_key(std::span<const Surfel* const> at, std::span<const Point2> points,
                  std::span<float> key) const;
  void sample_ambient(std::span<const Surfel* const> at, std::span<const Point2> points,
                      std::span<Vec3> ambient) const;
  /// What is mirrored and let through at up to k_batch surfels, seen along rays of the camera.
  void look_beyond(std::span<const Surfel* const> at, std::span<const Ray> rays,
                   std::span<Light* const> light) const;
  static constexpr std::size_t k_batch = 64;
  /// What all of the key light makes of a white surface there, at most one.
  float key_share(const Surfel& at) const;
  /// Light from `at` towards the eye that sent `ray`.
  Vec3 color(const Ray& ray, const Surfel& at, const Light& light) const;
  /// The same of floor and backdrop where nothing is near.
  Vec3 open_color(const Ray& ray, const Surfel& at) const;

 private:
  float key_from_behind(const Surfel& at, const Vec3& to_light) const;
  /// Sets seen[i] to whether nothing is on ray i, which goes to the light.
  void unshaded(std::span<const Ray> rays, std::span<std::uint8_t> seen, Rays kind) const;
  bool misses_contents(const Ray& ray) const;
  /// Light that comes back along up to k_batch rays. shades: of each, the share of the key light that is left
  /// in shadows.
  void incoming(std::span<const Ray> rays, std::span<const float> shades, std::span<Vec3> light) const;
  /// A ray inside a clear body; later the one that leaves it, and how far it was on the way [m].
  struct Passage {
    Ray ray;
    float way;
    bool ends_inside;  ///< at the floor or an obstacle that the body rests on, or at a body in it
  };
  /// Follows rays through the clear bodies that were entered at up to k_batch surfels.
  void pass_through(std::span<const Surfel* const> at, std::span<Passage> passages) const;
  void add_hit(const Ray& ray, const std::optional<Bodies::Hit>& hit, Surfel& seen) const;
  Surfel look_at_obstacles(const Ray& ray) const;
  float floor_fade(const Vec3& position) const;
  /// What a ray meets first of floor and obstacles; t is k_far where that is nothing.
  struct Solid {
    Vec3 normal, albedo;
    float t;
    bool is_floor;
  };
  Solid solid_on(const Ray& ray) const;
  std::optional<float> floor_hit(const Ray& ray) const;
  Vec3 to_key(const Point2& disc) const;

  const Bodies& bodies_;
  const Obstacles& obstacles_;
  const Environment& environment_;
  Vec3 center_;
  float view_size_;
  Tangents key_tangents_;
  float epsilon_;  // distance from a surface at which rays start [m]
  std::optional<Aabb> contents_;
  Vec3 floor_ambient_;
};

}  // namespace mallow::render

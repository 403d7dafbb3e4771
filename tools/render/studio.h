#pragma once

#include "mallow/vec3.h"
#include "render/renderer.h"

namespace mallow::render {

/// What a ray of the camera meets, and so how that answers light: floor and obstacles are dull, bodies as
/// their finish says.
enum class Look : std::uint8_t { none, floor, obstacle, jelly, clay };
inline Look look_of(Finish finish) {
  return finish == Finish::clay ? Look::clay : Look::jelly;
}

/// Light that reaches a point: what the surroundings send, and how much of the key light is seen.
struct Light {
  Vec3 ambient{0, 0, 0};  ///< mean radiance over the cosine-weighted hemisphere
  float key = 0;          ///< in [0, 1]
};

/// The light, the backdrop and the looks of materials; linear RGB in which 1 is white.
class Studio {
 public:
  explicit Studio(const Camera& camera);

  /// Towards the middle of the key light.
  const Vec3& key_direction() const { return key_direction_; }
  /// Tangent of the angle under which the key light's radius is seen.
  static constexpr float k_key_size = 0.16f;
  static constexpr float k_floor_albedo = 0.84f;

  /// What a ray sees that leaves the scene; `has_floor`: below the horizon it sees the floor.
  Vec3 sky(const Vec3& direction, bool has_floor) const;
  /// The same for a ray of the camera: nothing but a bright wall that the floor runs into.
  Vec3 backdrop(const Vec3& direction) const;
  /// How far the floor has faded into the backdrop there, in [0, 1].
  float floor_fade(const Vec3& position) const;

  /// Light that leaves a dull surface.
  Vec3 diffuse(const Vec3& albedo, const Vec3& normal, const Light& light) const;
  /// Light that leaves a surface towards the viewer.
  Vec3 shade(Look look, const Vec3& albedo, const Vec3& normal, const Vec3& view, const Light& light,
             bool has_floor) const;
  /// Share of light that crosses `thickness` [m] of jelly.
  float transmitted(float thickness) const;

 private:
  Vec3 shade_jelly(const Vec3& albedo, const Vec3& normal, const Vec3& view, const Light& light,
                   bool has_floor) const;
  Vec3 shade_clay(const Vec3& albedo, const Vec3& normal, const Vec3& view, const Light& light) const;
  // What leaves the floor where nothing is near.
  Vec3 open_floor() const;

  Vec3 key_direction_;
  Vec3 center_;
  float view_size_;
};

/// Film curve and sRGB: linear light to [0, 1] of the screen.
Vec3 develop(const Vec3& linear);

}  // namespace mallow::render

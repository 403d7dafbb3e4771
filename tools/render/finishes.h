#pragma once

#include <cstdint>

#include "mallow/appearance.h"
#include "render/environment.h"

namespace mallow::render {

/// What a ray of the camera meets, and so how that answers light: floor and obstacles are dull, bodies as
/// their finish says.
enum class Look : std::uint8_t { none, floor, obstacle, jelly, clay, cream, gloss, syrup };
inline Look look_of(Finish finish) {
  return static_cast<Look>(static_cast<int>(Look::jelly) + static_cast<int>(finish));
}

/// What a look does with light. Lengths are in half heights of the view: scenes have any unit.
struct Optics {
  float index = 1;      ///< of refraction; 1: no coat that mirrors
  float wrap = 0;       ///< cosine beyond the shadow's edge up to which light goes through the skin
  float free_path = 0;  ///< of light before it is scattered; 0: it is at the surface, nothing is seen through
  float color_depth = 0;  ///< way through it after which light has its colour (Beer and Lambert)
  float satin = 0;        ///< exponent of a broad highlight in place of a mirror; 0: none
  bool rough = false;     ///< V-shaped dull facets, see finishes.cpp

  bool is_clear() const { return free_path > 0; }
  bool is_coated() const { return index > 1 && satin == 0; }
};
const Optics& optics_of(Look look);

/// Light that reaches a point of a surface, and what is mirrored in it and seen through it.
struct Light {
  Eigen::Array<float, 8, 1> values = Eigen::Array<float, 8, 1>::Zero();

  /// Where nothing is near.
  static Light open() {
    Light light;
    light.key() = light.scattered() = 1;
    return light;
  }

  /// Mean radiance over the cosine-weighted hemisphere, less Environment::ambient().
  auto ambient() { return values.head<3>(); }
  auto ambient() const { return values.head<3>(); }
  float& key() { return values[3]; }  ///< share of the key light that is seen, in [0, 1]
  float key() const { return values[3]; }
  /// What comes towards the eye from beyond the surface: mirrored and let through, with the shares of both.
  auto beyond() { return values.segment<3>(4); }
  auto beyond() const { return values.segment<3>(4); }
  float& scattered() { return values[7]; }  ///< share that the inside scatters; 1 - that is let through
  float scattered() const { return values[7]; }
};

/// Share that a smooth surface mirrors (Schlick 1994). cosine: between its normal and the view, >= 0.
float mirrored(const Optics& optics, float cosine);

/// A surface as it is seen; directions are unit vectors away from it.
struct Seen {
  Look look;
  Vec3 albedo;
  Vec3 normal;
  Vec3 view;
};
/// Light that leaves a surface towards the viewer. ambient: Environment::ambient() of its normal.
Vec3 shade(const Environment& environment, const Seen& seen, const Vec3& ambient, const Light& light);

/// Tone curve and sRGB: linear light to [0, 1] of the screen.
Vec3 develop(const Vec3& linear);

}  // namespace mallow::render

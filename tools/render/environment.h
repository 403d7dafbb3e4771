#pragma once

#include <array>
#include <vector>

#include "mallow/vec3.h"
#include "render/hdr.h"
#include "render/renderer.h"

namespace mallow::render {

/// Light from far away: a sky all around and one soft light apart from it, the key. Linear RGB in which 1 is
/// what a white floor in the open sends back.
class Environment {
 public:
  static constexpr float k_floor_albedo = 0.62f;

  /// A studio: a cool sky over a warm key that hangs high, to the left of the camera and a little in front of
  /// it. Before a floor, what is below the horizon is that floor.
  Environment(const Camera& camera, bool has_floor);
  /// A picture of all around; the key is what is far brighter in it than the rest, such as the sun.
  /// `soft`: the same with fewer pixels, which the light is taken from. Both must outlive this.
  Environment(const HdrPicture& picture, const HdrPicture& soft, bool has_floor);

  /// Towards the middle of the key light.
  const Vec3& key_direction() const { return key_direction_; }
  /// What a white surface sends back that faces the key light.
  const Vec3& key_color() const { return key_; }
  /// Tangent of the angle under which the key light's radius is seen.
  float key_size() const { return key_size_; }

  /// What a ray sees that leaves the scene.
  Vec3 sky(const Vec3& direction) const;
  /// The same for a ray of the camera.
  Vec3 backdrop(const Vec3& direction) const;
  /// Mean of the sky over the cosine-weighted hemisphere around a normal (Ramamoorthi & Hanrahan 2001: nine
  /// spherical harmonics are within 3% of any sky's).
  Vec3 ambient(const Vec3& normal) const;
  /// The mean of the sky over all directions.
  const Vec3& mean_sky() const { return mean_sky_; }
  /// What leaves the floor where nothing is near.
  const Vec3& open_floor() const { return open_floor_; }

 private:
  Vec3 sky_above(const Vec3& direction) const;
  void set_up();

  const HdrPicture* picture_ = nullptr;  ///< null: the studio
  const HdrPicture* soft_ = nullptr;
  float exposure_ = 1;  ///< of the picture
  float most_ = 0;      ///< what is brighter in the picture is the key's [its units]
  bool has_floor_;
  Vec3 key_direction_{0, 0, 1};
  Vec3 key_{0, 0, 0};
  float key_size_;
  Vec3 open_floor_{0, 0, 0};
  Vec3 mean_sky_{0, 0, 0};
  std::array<Vec3, 9> harmonics_;  ///< of `ambient`
};

}  // namespace mallow::render

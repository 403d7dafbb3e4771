#include "render/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/mixing.h"

namespace mallow::render {
namespace {

constexpr float k_pi = std::numbers::pi_v<float>;

// The studio, by eye: a white floor in the open comes out at 1, the key gives six tenths of that.
const Vec3 k_key{0.78f, 0.735f, 0.67f};
constexpr float k_studio_key_size = 0.2f;
const Vec3 k_sky_horizon{0.31f, 0.335f, 0.37f};
const Vec3 k_sky_zenith{0.46f, 0.49f, 0.54f};
const Vec3 k_ground{0.22f, 0.215f, 0.21f};
// Behind the floor: darker above, so that what is bright stands out.
const Vec3 k_wall{0.34f, 0.385f, 0.45f};

// Samples of the sky for its harmonics, from pole to pole.
constexpr int k_rings = 24;

std::array<float, 9> harmonics(const Vec3& n) {
  const float x = n.x(), y = n.y(), z = n.z();
  return {0.282095f,
          0.488603f * y,
          0.488603f * z,
          0.488603f * x,
          1.092548f * x * y,
          1.092548f * y * z,
          0.315392f * (3 * z * z - 1),
          1.092548f * x * z,
          0.546274f * (x * x - y * y)};
}
// Share of each band in the mean over a hemisphere with the cosine.
constexpr std::array<float, 9> k_cosine{1, 2.0f / 3, 2.0f / 3, 2.0f / 3, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f};

float brightness(const Vec3& color) {
  return color.dot(Vec3(0.2126f, 0.7152f, 0.0722f));
}

}  // namespace

Environment::Environment(const Camera& camera, bool has_floor)
    : has_floor_(has_floor), key_(k_key), key_size_(k_studio_key_size) {
  const Vec3 back = camera.eye - camera.target;
  const float azimuth = std::atan2(back.y(), back.x()) - 65.0f * k_pi / 180;
  const float elevation = 52.0f * k_pi / 180;
  key_direction_ = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                    std::sin(elevation)};
  set_up();
}

Environment::Environment(const HdrPicture& picture, const HdrPicture& soft, bool has_floor)
    : picture_(&picture), soft_(&soft), has_floor_(has_floor), key_size_(k_studio_key_size) {
  // The key takes what is above eight times the mean.
  float mean = 0;
  soft.for_pixels(
      [&](const Vec3&, float angle, const Vec3& radiance) { mean += angle * brightness(radiance); });
  most_ = 8 * std::max(mean / (4 * k_pi), 1e-6f);
  Vec3 towards = Vec3::Zero();
  float key_angle = 0;
  soft.for_pixels([&](const Vec3& direction, float angle, const Vec3& radiance) {
    const float bright = brightness(radiance);
    if (bright <= most_) return;
    const Vec3 excess = radiance * (1 - most_ / bright) * angle;
    key_ += excess / k_pi;
    towards += brightness(excess) * direction;
    key_angle += angle;
  });
  if (towards.norm() > 0) key_direction_ = towards.normalized();
  if (key_angle > 0) key_size_ = std::clamp(std::sqrt(key_angle / k_pi), 0.02f, 0.4f);
  set_up();
  // Exposed so that a white floor in the open comes out at 1.
  const float white = brightness(ambient(Vec3::UnitZ()) + key_ * std::max(0.0f, key_direction_.z()));
  exposure_ = 1 / std::max(white, 1e-6f);
  key_ *= exposure_;
  set_up();
}

void Environment::set_up() {
  const bool floor_below = has_floor_;
  const auto gather = [&] {
    harmonics_.fill(Vec3::Zero());
    mean_sky_.setZero();
    constexpr float k_share = 4 * k_pi / (2 * k_rings * k_rings);  // of equal areas [sr]
    for (int ring = 0; ring < k_rings; ++ring) {
      const float z = 1 - 2 * (static_cast<float>(ring) + 0.5f) / k_rings;
      const float radius = std::sqrt(1 - z * z);
      for (int k = 0; k < 2 * k_rings; ++k) {
        const float around = 2 * k_pi * (static_cast<float>(k) + 0.5f) / (2 * k_rings);
        const Vec3 direction(radius * std::cos(around), radius * std::sin(around), z);
        const Vec3 radiance = sky(direction);
        const std::array<float, 9> basis = harmonics(direction);
        for (std::size_t i = 0; i < 9; ++i) harmonics_[i] += k_share * k_cosine[i] * basis[i] * radiance;
        mean_sky_ += k_share / (4 * k_pi) * radiance;
      }
    }
  };
  // The floor's own light is that of the sky above it.
  has_floor_ = false;
  gather();
  open_floor_ = k_floor_albedo * (key_ * std::max(0.0f, key_direction_.z()) + ambient(Vec3::UnitZ()));
  has_floor_ = floor_below;
  if (has_floor_) gather();
}

Vec3 Environment::sky_above(const Vec3& direction) const {
  if (picture_ == nullptr) return mix(k_sky_horizon, k_sky_zenith, std::max(0.0f, direction.z()));
  const Vec3 seen = soft_->at(direction);
  return exposure_ * seen * std::min(1.0f, most_ / std::max(brightness(seen), 1e-6f));
}

Vec3 Environment::sky(const Vec3& direction) const {
  // A wide seam, because glossy bodies show it.
  const float above = smoothstep(-0.4f, 0.4f, direction.z());
  if (picture_ != nullptr && !has_floor_) return sky_above(direction);
  const Vec3& below = has_floor_ ? open_floor_ : k_ground;
  return above >= 1 ? sky_above(direction) : mix(below, sky_above(direction), above);
}

Vec3 Environment::backdrop(const Vec3& direction) const {
  if (picture_ != nullptr) return exposure_ * picture_->at(direction);
  return mix(open_floor_, k_wall, smoothstep(-0.22f, 0.45f, direction.z()));
}

Vec3 Environment::ambient(const Vec3& normal) const {
  const std::array<float, 9> basis = harmonics(normal);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 9; ++i) sum += basis[i] * harmonics_[i];
  return sum.cwiseMax(0.0f);
}

}  // namespace mallow::render

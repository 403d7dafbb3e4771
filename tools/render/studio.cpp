#include "render/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/obstacles.h"

namespace mallow::render {
namespace {

// Chosen by eye, so that the open floor comes out just below white and shadows keep colour.
const Vec3 k_key{0.74f, 0.715f, 0.68f};
const Vec3 k_sky_horizon{0.32f, 0.335f, 0.355f};
const Vec3 k_sky_zenith{0.45f, 0.465f, 0.485f};
const Vec3 k_ground{0.26f, 0.255f, 0.25f};
// Mean of the sky over the cosine-weighted upper hemisphere, where z has the mean 2/3.
const Vec3 k_sky_mean = k_sky_horizon + (k_sky_zenith - k_sky_horizon) * (2.0f / 3);

float smoothstep(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

Vec3 mix(const Vec3& a, const Vec3& b, float t) {
  return a + (b - a) * t;
}

// Light from all around a translucent body that has crossed it (in place of a second and later bounces).
constexpr float k_scattered = 0.08f;
// Cosine at which the light wraps around a translucent body to nothing.
constexpr float k_wrap = 0.25f;
// Free path in a body, in half heights of the view.
constexpr float k_free_path = 0.10f;

// Clay is rough: V-shaped dull facets whose slopes have the standard deviation σ shade and hide each other
// (Oren & Nayar 1994, the qualitative model). It shows as flat, soft shading that is brighter towards the
// light's side.
constexpr float k_slope_variance = 0.12f;  // σ², σ = 20 degrees, by eye
constexpr float k_facets_level = 1 - 0.5f * k_slope_variance / (k_slope_variance + 0.33f);   // A
constexpr float k_facets_backwards = 0.45f * k_slope_variance / (k_slope_variance + 0.09f);  // B
// A faint sheen, as of clay that is not quite dry: 4% of the light, which is what a coat mirrors head-on.
constexpr float k_sheen_exponent = 8.0f;
constexpr float k_sheen = 0.04f * (k_sheen_exponent + 2) / 8;

}  // namespace

Studio::Studio(const Camera& camera) : center_(camera.target), view_size_(view_size(camera)) {
  // The key light hangs high, to the left of the camera and a little in front of it.
  const Vec3 back = camera.eye - camera.target;
  const float azimuth = std::atan2(back.y(), back.x()) - 65.0f * std::numbers::pi_v<float> / 180;
  const float elevation = 52.0f * std::numbers::pi_v<float> / 180;
  key_direction_ = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                    std::sin(elevation)};
}

Vec3 Studio::sky(const Vec3& direction, bool has_floor) const {
  const Vec3 above = mix(k_sky_horizon, k_sky_zenith, std::max(0.0f, direction.z()));
  const Vec3 below = has_floor ? open_floor() : k_ground;
  // A wide seam, because glossy bodies show it.
  return mix(below, above, smoothstep(-0.4f, 0.4f, direction.z()));
}

Vec3 Studio::open_floor() const {
  return k_floor_albedo * (k_key * key_direction_.z() + k_sky_mean);
}

Vec3 Studio::backdrop(const Vec3& direction) const {
  return mix(open_floor(), Vec3(0.95f, 0.96f, 0.97f), smoothstep(-0.25f, 0.35f, direction.z()));
}

float Studio::floor_fade(const Vec3& position) const {
  const float distance = (position - center_).head<2>().norm();
  return smoothstep(2.0f * view_size_, 6.5f * view_size_, distance);
}

Vec3 Studio::diffuse(const Vec3& albedo, const Vec3& normal, const Light& light) const {
  const float cosine = std::max(0.0f, normal.dot(key_direction_));
  return albedo.cwiseProduct(k_key * (cosine * light.key) + light.ambient);
}

Vec3 Studio::shade(Look look, const Vec3& albedo, const Vec3& normal, const Vec3& view, const Light& light,
                   bool has_floor) const {
  if (look == Look::jelly) return shade_jelly(albedo, normal, view, light, has_floor);
  if (look == Look::clay) return shade_clay(albedo, normal, view, light);
  return diffuse(albedo, normal, light);
}

Vec3 Studio::shade_jelly(const Vec3& albedo, const Vec3& normal, const Vec3& view, const Light& light,
                         bool has_floor) const {
  const float cosine = normal.dot(key_direction_);
  float direct = std::max(0.0f, (cosine + k_wrap) / (1 + k_wrap));
  if (cosine < 0) direct += 0.35f * -cosine;  // what shines through from behind
  const Vec3 ambient = mix(light.ambient, k_sky_mean, k_scattered);
  Vec3 color = albedo.cwiseProduct(k_key * (direct * light.key) + ambient);

  // A clear coat: Schlick's Fresnel, bounded at grazing angles as for a coat that is not quite smooth.
  const float facing = std::max(0.0f, normal.dot(view));
  const float fresnel = 0.04f + 0.22f * std::pow(1 - facing, 5.0f);
  const Vec3 reflected = 2 * normal.dot(view) * normal - view;
  const float openness = std::min(1.0f, light.ambient.sum() / k_sky_mean.sum());
  const float softbox = smoothstep(0.90f, 0.975f, reflected.dot(key_direction_)) * light.key;
  color += fresnel * (openness * sky(reflected, has_floor) + softbox * 7.0f * k_key);
  return color;
}

Vec3 Studio::shade_clay(const Vec3& albedo, const Vec3& normal, const Vec3& view, const Light& light) const {
  const float to_key = std::max(0.0f, normal.dot(key_direction_));
  const float to_eye = std::max(0.0f, normal.dot(view));
  // cos(φ_i - φ_r) sin α tan β, with α the larger and β the smaller angle to the normal.
  const float aligned = key_direction_.dot(view) - to_key * to_eye;
  const float backwards = std::max(0.0f, aligned) / std::max({to_key, to_eye, 1e-3f});
  const float facets = to_key * (k_facets_level + k_facets_backwards * backwards);
  // Light from all around has no direction that facets could single out.
  Vec3 color = albedo.cwiseProduct(k_key * (facets * light.key) + light.ambient);

  // Blinn's lobe, normalised, so broad that nothing is mirrored in it.
  const float across = std::max(0.0f, normal.dot((key_direction_ + view).normalized()));
  color += k_key * (k_sheen * std::pow(across, k_sheen_exponent) * to_key * light.key);
  return color;
}

float Studio::transmitted(float thickness) const {
  return std::exp(-thickness / (k_free_path * view_size_));
}

Vec3 develop(const Vec3& linear) {
  return linear.unaryExpr([](float x) {
    // Straight below the shoulder, so that colours stay what the palette says; highlights roll off to white.
    constexpr float k_shoulder = 0.7f;
    x = std::max(0.0f, x);
    if (x > k_shoulder) x = k_shoulder + (1 - k_shoulder) * std::tanh((x - k_shoulder) / (1 - k_shoulder));
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  });
}

}  // namespace mallow::render

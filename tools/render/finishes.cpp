#include "render/finishes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/mixing.h"

namespace mallow::render {
namespace {

// By number of the look. Indices: jelly [water with a twentieth gelatine], syrup between water and honey
// (1.33, 1.49), coats as of fat or plastic.
constexpr std::array<Optics, 8> k_optics{{
    {},
    {},
    {},
    {.index = 1.35f, .wrap = 0.25f, .free_path = 0.35f, .color_depth = 0.20f},
    {.index = 1.5f, .satin = 8, .rough = true},
    {.index = 1.4f, .wrap = 0.5f, .satin = 20},
    {.index = 1.5f},
    {.index = 1.45f, .wrap = 0.25f, .free_path = 2.0f, .color_depth = 0.3f},
}};

// Clay is rough: V-shaped dull facets whose slopes have the standard deviation σ shade and hide each other
// (Oren & Nayar 1994, the qualitative model). It shows as flat, soft shading that is brighter towards the
// light's side.
constexpr float k_slope_variance = 0.12f;  // σ², σ = 20 degrees, by eye
constexpr float k_facets_level = 1 - 0.5f * k_slope_variance / (k_slope_variance + 0.33f);   // A
constexpr float k_facets_backwards = 0.45f * k_slope_variance / (k_slope_variance + 0.09f);  // B

// What shines through a clear body from behind, of what is not lost on the way.
constexpr float k_from_behind = 0.35f;
// Light from all around inside cream, in place of what goes in elsewhere and comes out here.
constexpr float k_inner = 0.12f;

// What is scattered inside a clear body has come so often through the depth that gives it its colour.
constexpr float k_scattered_way = 1.4f;

/// The tone curve, by linear pieces: the powers in it would take a fifth of the time of a picture.
class Curve {
 public:
  Curve() {
    for (std::size_t i = 0; i < k_size; ++i) points_[i] = exact(static_cast<float>(i) / k_per_unit);
  }
  float operator()(float x) const {
    const float place = std::clamp(x * k_per_unit, 0.0f, k_size - 1.001f);
    const auto i = static_cast<std::size_t>(place);
    return points_[i] + (place - static_cast<float>(i)) * (points_[i + 1] - points_[i]);
  }

 private:
  static constexpr std::size_t k_size = 4096;
  static constexpr float k_per_unit = 1024;
  static float exact(float x) {
    // Straight below the shoulder, so that colours stay what the palette says; highlights roll off to white.
    constexpr float k_shoulder = 0.7f;
    if (x > k_shoulder) x = k_shoulder + (1 - k_shoulder) * std::tanh((x - k_shoulder) / (1 - k_shoulder));
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  }
  std::array<float, k_size> points_;
};
const Curve k_curve;

/// Share of the key light that leaves a surface, as a factor on its albedo.
Vec3 direct(const Optics& optics, const Seen& seen, const Vec3& to_key) {
  const float cosine = seen.normal.dot(to_key);
  if (optics.rough) {
    const float in = std::max(0.0f, cosine), out = std::max(0.0f, seen.normal.dot(seen.view));
    // cos(φ_i - φ_r) sin α tan β, with α the larger and β the smaller angle to the normal.
    const float aligned = to_key.dot(seen.view) - in * out;
    const float backwards = std::max(0.0f, aligned) / std::max({in, out, 1e-3f});
    return Vec3::Constant(in * (k_facets_level + k_facets_backwards * backwards));
  }
  // Red light goes farther through skin, milk and gelatine than blue.
  const Vec3 wrap = optics.wrap * Vec3(1.0f, 0.75f, 0.6f);
  Vec3 share = (Vec3::Constant(cosine) + wrap).cwiseQuotient(Vec3::Ones() + wrap).cwiseMax(0.0f);
  if (optics.is_clear() && cosine < 0) share += Vec3::Constant(k_from_behind * -cosine);
  return share;
}

/// Blinn's lobe, normalised.
Vec3 satin_highlight(const Optics& optics, const Seen& seen, const Environment& environment, float key) {
  const Vec3& to_key = environment.key_direction();
  const float across = std::max(0.0f, seen.normal.dot((to_key + seen.view).normalized()));
  const float lobe = mirrored(optics, 1) * (optics.satin + 2) / 8 * std::pow(across, optics.satin);
  return environment.key_color() * (lobe * std::max(0.0f, seen.normal.dot(to_key)) * key);
}

/// The key light in a smooth coat: a softbox with a blurred edge.
Vec3 mirrored_key(const Optics& optics, const Seen& seen, const Environment& environment, float key) {
  const float cosine = std::max(0.0f, seen.normal.dot(seen.view));
  const Vec3 reflected = 2 * seen.normal.dot(seen.view) * seen.normal - seen.view;
  const float edge = 1 - 0.5f * environment.key_size() * environment.key_size();
  const float width = 1.4f * (1 - edge);
  const float box = smoothstep(edge - width, edge + 0.3f * width, reflected.dot(environment.key_direction()));
  // All of the key's light from the angle that it fills.
  const float brightness = std::min(30.0f, 1 / (environment.key_size() * environment.key_size()));
  return mirrored(optics, cosine) * box * key * brightness * environment.key_color();
}

}  // namespace

const Optics& optics_of(Look look) {
  return k_optics[static_cast<std::size_t>(look)];
}

float mirrored(const Optics& optics, float cosine) {
  const float head_on = (optics.index - 1) / (optics.index + 1);
  const float level = head_on * head_on, miss = 1 - cosine, square = miss * miss;
  // Bounded at grazing angles, as for a coat that is not quite smooth.
  return level + (0.6f - level) * square * square * miss;
}

Vec3 shade(const Environment& environment, const Seen& seen, const Vec3& open, const Light& light) {
  const Optics& optics = optics_of(seen.look);
  Vec3 ambient = (open + light.ambient().matrix()).cwiseMax(0.0f);
  if (optics.wrap > 0) ambient = mix(ambient, environment.mean_sky(), k_inner);
  // What is scattered inside a clear body has gone some way through it.
  const Vec3 albedo = optics.is_clear() ? Vec3(seen.albedo.array().pow(k_scattered_way)) : seen.albedo;
  Vec3 color = albedo.cwiseProduct(
      environment.key_color().cwiseProduct(direct(optics, seen, environment.key_direction())) * light.key() +
      ambient);
  if (optics.satin > 0) return color + satin_highlight(optics, seen, environment, light.key());
  if (!optics.is_coated()) return color;
  const float through = 1 - mirrored(optics, std::max(0.0f, seen.normal.dot(seen.view)));
  return through * light.scattered() * color + light.beyond().matrix() +
         mirrored_key(optics, seen, environment, light.key());
}

Vec3 develop(const Vec3& linear) {
  return linear.unaryExpr([](float x) { return k_curve(x); });
}

}  // namespace mallow::render

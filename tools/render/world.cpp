#include "render/world.h"

#include <algorithm>
#include <cmath>

namespace mallow::render {
namespace {

// Warm and darker than the floor, so that bodies and floor both stand out from it.
const Vec3 k_obstacle_albedo{0.56f, 0.54f, 0.515f};

}  // namespace

World::World(const Bodies& bodies, std::span<const Collider> colliders, const Camera& camera)
    : bodies_(bodies),
      obstacles_(colliders, camera),
      studio_(camera),
      key_tangents_(tangents(studio_.key_direction())),
      // Well above the rounding of float coordinates at the eye's distance.
      epsilon_(2e-6f * (camera.eye.norm() + camera.target.norm()) + 2e-4f * view_size(camera)) {}

std::optional<float> World::floor_hit(const Ray& ray) const {
  if (!obstacles_.floor() || ray.direction.z() >= 0) return std::nullopt;
  const float t = (*obstacles_.floor() - ray.origin.z()) / ray.direction.z();
  return t > 0 ? std::optional(t) : std::nullopt;
}

Surfel World::look(const Ray& ray) const {
  Surfel seen;
  if (const auto t = floor_hit(ray)) {
    const Vec3 position = ray.at(*t);
    const float fade = studio_.floor_fade(position);
    if (fade < 1) {
      seen = {.position = position,
              .outside = position,
              .normal = Vec3::UnitZ(),
              .albedo = Vec3::Constant(Studio::k_floor_albedo),
              .distance = *t,
              .fade = fade,
              .look = Look::floor};
    } else {
      seen.distance = *t;
    }
  }
  // A face that lies in the floor is drawn before it.
  if (const auto hit = obstacles_.nearest(ray, seen.distance + epsilon_)) {
    const Vec3 position = ray.at(hit->t);
    seen = {.position = position,
            .outside = position,
            .normal = hit->normal,
            .albedo = k_obstacle_albedo,
            .distance = hit->t,
            .look = Look::obstacle,
            .shape = hit->shape};
  }
  if (const auto hit = bodies_.nearest(ray, seen.distance)) {
    seen = {.position = hit->position,
            .outside = hit->outside,
            .normal = hit->normal,
            .albedo = hit->albedo,
            .distance = hit->t,
            .look = look_of(hit->finish)};
  }
  seen.veil = obstacles_.veil(ray, seen.distance);
  return seen;
}

Vec3 World::to_key(const Point2& disc) const {
  return (studio_.key_direction() +
          Studio::k_key_size * (disc.x() * key_tangents_.u + disc.y() * key_tangents_.v))
      .normalized();
}

float World::key_seen(const Surfel& at, const Vec3& to_light) const {
  if (at.normal.dot(to_light) > 0) {
    const Ray ray{at.outside + epsilon_ * at.normal, to_light};
    return bodies_.occludes(ray) || obstacles_.shades(ray) ? 0.0f : 1.0f;
  }
  if (at.look != Look::jelly) return 0;
  // Light that comes from behind crosses the body, and is lost in it with its thickness there.
  const Ray inward{at.position - epsilon_ * at.normal, to_light};
  const float thickness = bodies_.distance(inward);
  if (thickness == k_far) return obstacles_.shades(inward) ? 0.0f : 1.0f;
  const float share = studio_.transmitted(thickness);
  if (share < 0.01f) return 0;
  const Ray onward{inward.at(thickness + epsilon_), to_light};
  return bodies_.occludes(onward) || obstacles_.shades(onward) ? 0.0f : share;
}

Vec3 World::incoming(const Ray& ray) const {
  const auto floor = floor_hit(ray);
  float nearest = floor.value_or(k_far);
  Vec3 normal = Vec3::UnitZ();
  Vec3 albedo = Vec3::Constant(Studio::k_floor_albedo);
  bool hit = floor.has_value();
  if (const auto obstacle = obstacles_.nearest(ray, nearest)) {
    nearest = obstacle->t;
    normal = obstacle->normal;
    albedo = k_obstacle_albedo;
    hit = true;
  }
  if (const auto body = bodies_.nearest(ray, nearest)) {
    nearest = body->t;
    normal = body->normal;
    albedo = body->albedo;
    hit = true;
  }
  if (!hit) return studio_.sky(ray.direction, false);
  const Vec3 position = ray.at(nearest) + epsilon_ * normal;
  if (floor && nearest == *floor && studio_.floor_fade(position) > 0.5f)
    return studio_.sky(ray.direction, true);
  // Later bounces are part of the sky's light, which no surface here blocks.
  Light light{.ambient = 0.7f * studio_.sky(normal, obstacles_.floor().has_value()), .key = 0};
  if (normal.dot(studio_.key_direction()) > 0) {
    const Ray to_light{position, studio_.key_direction()};
    light.key = bodies_.occludes(to_light) || obstacles_.shades(to_light) ? 0.0f : 1.0f;
  }
  return studio_.diffuse(albedo, normal, light);
}

Light World::gather(const Surfel& at, std::span<const Point2> key, std::span<const Point2> hemisphere) const {
  Light light;
  const Tangents frame = tangents(at.normal);
  const Vec3 origin = at.outside + epsilon_ * at.normal;
  for (const Point2& disc : key) light.key += key_seen(at, to_key(disc));
  for (const Point2& disc : hemisphere) {
    const float height = std::sqrt(std::max(0.0f, 1 - disc.squaredNorm()));
    const Vec3 direction = disc.x() * frame.u + disc.y() * frame.v + height * at.normal;
    light.ambient += incoming({origin, direction});
  }
  light.key /= static_cast<float>(key.size());
  light.ambient /= static_cast<float>(hemisphere.size());
  return light;
}

Vec3 World::color(const Ray& ray, const Surfel& at, const Light& light) const {
  const Vec3 backdrop = studio_.backdrop(ray.direction);
  Vec3 color = backdrop;
  if (at.look != Look::none) {
    const Vec3 surface =
        studio_.shade(at.look, at.albedo, at.normal, -ray.direction, light, obstacles_.floor().has_value());
    color = surface + (backdrop - surface) * at.fade;
  }
  return color + (Vec3::Constant(at.veil.light) - color) * at.veil.cover;
}

}  // namespace mallow::render

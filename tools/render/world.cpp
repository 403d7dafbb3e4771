#include "render/world.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/mixing.h"

namespace mallow::render {
namespace {

// Warm and darker than the floor, so that bodies and floor both stand out from it.
const Vec3 k_obstacle_albedo{0.42f, 0.405f, 0.385f};
const Vec3 k_floor_albedo = Vec3::Constant(Environment::k_floor_albedo);

// Share of the sky that a surface is taken to see that a ray meets: later bounces are in it.
constexpr float k_second_sky = 0.75f;
// Share of the key light on what is seen through a clear body in its own shadow: some goes through.
constexpr float k_clear_shade = 0.35f;
// A gap below a clear body is taken as none, in half heights of the view. What rests on a thing wavers by
// less around it: floors that are seen from below are open, and narrow gaps mirror.
constexpr float k_wetted = 0.015f;
// Times that light is thrown back inside a clear body.
constexpr int k_inner_bounces = 2;
// Free paths after which nothing is seen through a clear body any more.
constexpr float k_opaque = 4;
constexpr std::array<float, World::k_batch> k_all_shade{};
// Coats that mirror less show the sky alone.
constexpr float k_mirror_traced = 0.05f;

/// The direction behind a surface whose normal faces the ray; ratio: index here by index there. Nothing where
/// all is mirrored.
std::optional<Vec3> refracted(const Vec3& direction, const Vec3& normal, float ratio) {
  const float cosine = -normal.dot(direction);
  const float rest = 1 - ratio * ratio * (1 - cosine * cosine);
  if (rest < 0) return std::nullopt;
  return (ratio * direction + (ratio * cosine - std::sqrt(rest)) * normal).normalized();
}

Vec3 reflected(const Vec3& direction, const Vec3& normal) {
  return direction - 2 * normal.dot(direction) * normal;
}

std::optional<Aabb> joined(const std::optional<Aabb>& a, const std::optional<Aabb>& b) {
  if (!a || !b) return a ? a : b;
  return Aabb{a->min.cwiseMin(b->min), a->max.cwiseMax(b->max)};
}

}  // namespace

World::World(const Bodies& bodies, const Obstacles& obstacles, const Environment& environment,
             const Camera& camera)
    : bodies_(bodies),
      obstacles_(obstacles),
      environment_(environment),
      center_(camera.target),
      view_size_(view_size(camera)),
      key_tangents_(tangents(environment.key_direction())),
      // Well above the rounding of float coordinates at the eye's distance.
      epsilon_(2e-6f * (camera.eye.norm() + camera.target.norm()) + 2e-4f * view_size_),
      floor_ambient_(environment.ambient(Vec3::UnitZ())) {
  if (!obstacles.is_bounded()) return;
  contents_ = joined(bodies.box(), obstacles.box());
  if (!contents_) contents_ = Aabb{Vec3::Constant(k_far), Vec3::Constant(-k_far)};
  const Vec3 margin = Vec3::Constant(4 * epsilon_);
  contents_ = Aabb{contents_->min - margin, contents_->max + margin};
}

bool World::misses_contents(const Ray& ray) const {
  return contents_ && !meets(ray, *contents_);
}

std::optional<float> World::floor_hit(const Ray& ray) const {
  if (!obstacles_.floor() || ray.direction.z() >= 0) return std::nullopt;
  const float t = (*obstacles_.floor() - ray.origin.z()) / ray.direction.z();
  return t > 0 ? std::optional(t) : std::nullopt;
}

World::Solid World::solid_on(const Ray& ray) const {
  const auto floor = floor_hit(ray);
  const float t = floor.value_or(k_far);
  if (const auto obstacle = obstacles_.nearest(ray, t))
    return {obstacle->normal, k_obstacle_albedo, obstacle->t, false};
  return {Vec3::UnitZ(), k_floor_albedo, t, floor.has_value()};
}

float World::floor_fade(const Vec3& position) const {
  const float square = (position - center_).head<2>().squaredNorm();
  const float from = 2.0f * view_size_;
  if (square <= from * from) return 0;
  return smoothstep(from, 6.5f * view_size_, std::sqrt(square));
}

Surfel World::look_past(const Ray& ray) const {
  Surfel seen;
  const auto t = floor_hit(ray);
  if (!t) return seen;
  seen.distance = *t;
  const Vec3 position = ray.at(*t);
  const float fade = floor_fade(position);
  if (fade >= 1) return seen;
  seen.position = seen.outside = position;
  seen.normal = Vec3::UnitZ();
  seen.albedo = k_floor_albedo;
  seen.fade = fade;
  seen.look = Look::floor;
  return seen;
}

Surfel World::look_at_obstacles(const Ray& ray) const {
  Surfel seen = look_past(ray);
  // A face that lies in the floor is drawn before it.
  const auto hit = obstacles_.nearest(ray, seen.distance + epsilon_);
  if (!hit) return seen;
  const Vec3 position = ray.at(hit->t);
  return {.position = position,
          .outside = position,
          .normal = hit->normal,
          .albedo = k_obstacle_albedo,
          .distance = hit->t,
          .look = Look::obstacle,
          .shape = hit->shape};
}

void World::add_hit(const Ray& ray, const std::optional<Bodies::Hit>& hit, Surfel& seen) const {
  if (hit) {
    seen = {.position = hit->position,
            .outside = hit->outside,
            .normal = hit->normal,
            .albedo = hit->albedo,
            .distance = hit->t,
            .look = look_of(hit->finish)};
  }
  seen.veil = obstacles_.veil(ray, seen.distance);
}

Surfel World::look(const Ray& ray) const {
  Surfel seen = look_at_obstacles(ray);
  add_hit(ray, bodies_.nearest(ray, seen.distance), seen);
  return seen;
}

void World::look(std::span<const Ray> rays, std::span<Surfel* const> seen) const {
  std::array<float, k_batch> nearest;
  std::array<std::optional<Bodies::Hit>, k_batch> hits;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    *seen[i] = look_at_obstacles(rays[i]);
    nearest[i] = seen[i]->distance;
  }
  bodies_.nearest(rays, nearest, hits, Rays::together);
  for (std::size_t i = 0; i < rays.size(); ++i) add_hit(rays[i], hits[i], *seen[i]);
}

Vec3 World::to_key(const Point2& disc) const {
  return (environment_.key_direction() +
          environment_.key_size() * (disc.x() * key_tangents_.u + disc.y() * key_tangents_.v))
      .normalized();
}

void World::unshaded(std::span<const Ray> rays, std::span<std::uint8_t> seen, Rays kind) const {
  std::array<Ray, k_batch> asked;
  std::array<std::uint8_t, k_batch> free, place;
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    seen[i] = 1;
    if (misses_contents(rays[i])) continue;
    seen[i] = obstacles_.shades(rays[i]) ? 0 : 1;
    if (seen[i] == 0) continue;
    asked[count] = rays[i];
    free[count] = 1;
    place[count++] = static_cast<std::uint8_t>(i);
  }
  bodies_.occlude({asked.data(), count}, {free.data(), count}, kind);
  for (std::size_t k = 0; k < count; ++k) seen[place[k]] = free[k];
}

float World::key_share(const Surfel& at) const {
  const float cosine = at.normal.dot(environment_.key_direction()) + optics_of(at.look).wrap;
  return std::clamp(cosine, 0.0f, 1.0f) * environment_.key_color().mean();
}

float World::key_from_behind(const Surfel& at, const Vec3& to_light) const {
  const Optics& optics = optics_of(at.look);
  if (!optics.is_clear()) return 0;
  // Light that comes from behind crosses the body, and is lost in it with its thickness there.
  const Ray inward{at.position - epsilon_ * at.normal, to_light};
  const float thickness = bodies_.distance(inward);
  if (thickness == k_far) return obstacles_.shades(inward) ? 0.0f : 1.0f;
  const float share = std::exp(-thickness / (optics.free_path * view_size_));
  if (share < 0.01f) return 0;
  const Ray onward{inward.at(thickness + epsilon_), to_light};
  return bodies_.occludes(onward) || obstacles_.shades(onward) ? 0.0f : share;
}

void World::sample_key(std::span<const Surfel* const> at, std::span<const Point2> points,
                       std::span<float> key) const {
  std::array<Ray, k_batch> rays;
  std::array<std::uint8_t, k_batch> seen, place;
  std::size_t count = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Vec3 to_light = to_key(points[i]);
    if (at[i]->normal.dot(to_light) > 0) {
      rays[count] = {at[i]->outside + epsilon_ * at[i]->normal, to_light};
      place[count++] = static_cast<std::uint8_t>(i);
    } else {
      key[i] = key_from_behind(*at[i], to_light);
    }
  }
  unshaded({rays.data(), count}, {seen.data(), count}, Rays::together);
  for (std::size_t k = 0; k < count; ++k) key[place[k]] = seen[k];
}

void World::sample_ambient(std::span<const Surfel* const> at, std::span<const Point2> points,
                           std::span<Vec3> ambient) const {
  std::array<Ray, k_batch> rays;
  std::array<Vec3, k_batch> light;
  std::array<std::uint8_t, k_batch> place;
  std::size_t count = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Surfel& surfel = *at[i];
    const Tangents frame = tangents(surfel.normal);
    const float height = std::sqrt(std::max(0.0f, 1 - points[i].squaredNorm()));
    const Vec3 direction = points[i].x() * frame.u + points[i].y() * frame.v + height * surfel.normal;
    ambient[i].setZero();
    const Ray ray{surfel.outside + epsilon_ * surfel.normal, direction};
    if (direction.z() > 0 && misses_contents(ray)) continue;  // the sky that ambient() has already
    rays[count] = ray;
    place[count++] = static_cast<std::uint8_t>(i);
  }
  incoming({rays.data(), count}, k_all_shade, {light.data(), count});
  for (std::size_t k = 0; k < count; ++k) ambient[place[k]] = light[k] - environment_.sky(rays[k].direction);
}

void World::incoming(std::span<const Ray> rays, std::span<const float> shades, std::span<Vec3> light) const {
  std::array<Solid, k_batch> met;
  std::array<float, k_batch> nearest;
  std::array<std::optional<Bodies::Hit>, k_batch> hits;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    met[i] = solid_on(rays[i]);
    // From right above it all that is between is the underside of what rests on it.
    const bool is_down = met[i].t * -met[i].normal.dot(rays[i].direction) < 2 * epsilon_ && met[i].t < k_far;
    nearest[i] = is_down || misses_contents(rays[i]) ? -1 : met[i].t;
  }
  bodies_.nearest(rays, {nearest.data(), rays.size()}, {hits.data(), rays.size()}, Rays::scattered);

  std::array<Ray, k_batch> to_light;
  std::array<float, k_batch> cosines;
  std::array<std::uint8_t, k_batch> seen, place;
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Solid& at = met[i];
    if (hits[i]) at = {hits[i]->normal, hits[i]->albedo, hits[i]->t, false};
    const Vec3 position = rays[i].at(at.t) + epsilon_ * at.normal;
    if (at.t == k_far || (at.is_floor && floor_fade(position) > 0.5f)) {
      light[i] = environment_.sky(rays[i].direction);
      continue;
    }
    light[i] = at.albedo.cwiseProduct(k_second_sky *
                                      (at.is_floor ? floor_ambient_ : environment_.ambient(at.normal)));
    const float cosine = at.normal.dot(environment_.key_direction());
    if (cosine <= 0) continue;
    to_light[count] = {position, environment_.key_direction()};
    cosines[count] = cosine;
    place[count++] = static_cast<std::uint8_t>(i);
  }
  unshaded({to_light.data(), count}, {seen.data(), count}, Rays::scattered);
  for (std::size_t k = 0; k < count; ++k) {
    const float share = cosines[k] * (seen[k] != 0 ? 1 : shades[place[k]]);
    light[place[k]] += share * met[place[k]].albedo.cwiseProduct(environment_.key_color());
  }
}

void World::look_beyond(std::span<const Surfel* const> at, std::span<const Ray> rays,
                        std::span<Light* const> light) const {
  std::array<Ray, k_batch> mirrors, lets;
  std::array<Passage, k_batch> passages;
  std::array<const Surfel*, k_batch> entered;
  std::array<Vec3, k_batch> shares, tints, from;
  std::array<float, k_batch> shades;
  std::array<std::uint8_t, k_batch> mirror_place, let_place;
  std::size_t mirror_count = 0, let_count = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Optics& optics = optics_of(at[i]->look);
    light[i]->scattered() = 1;
    light[i]->beyond().setZero();
    if (!optics.is_coated()) continue;
    const float share = mirrored(optics, std::max(0.0f, -at[i]->normal.dot(rays[i].direction)));
    const Ray mirror{at[i]->outside + epsilon_ * at[i]->normal, reflected(rays[i].direction, at[i]->normal)};
    if (share < k_mirror_traced) {
      light[i]->beyond() = share * environment_.sky(mirror.direction).array();
    } else {
      mirrors[mirror_count] = mirror;
      shares[mirror_count] = Vec3::Constant(share);
      mirror_place[mirror_count++] = static_cast<std::uint8_t>(i);
    }
    if (!optics.is_clear()) continue;
    passages[let_count].ray = {
        at[i]->position - epsilon_ * at[i]->normal,
        refracted(rays[i].direction, at[i]->normal, 1 / optics.index).value_or(rays[i].direction)};
    entered[let_count] = at[i];
    tints[let_count] = Vec3::Constant(1 - share);
    let_place[let_count++] = static_cast<std::uint8_t>(i);
  }
  pass_through({entered.data(), let_count}, {passages.data(), let_count});
  std::size_t left = 0;
  for (std::size_t k = 0; k < let_count; ++k) {
    const Optics& optics = optics_of(entered[k]->look);
    const float way = passages[k].way / view_size_;
    const float let_through = std::exp(-way / optics.free_path);
    light[let_place[k]]->scattered() = 1 - let_through;
    if (way > optics.free_path * k_opaque) continue;
    // What lights the ground, or a body within, has come through this body too.
    const float colored = (passages[k].ends_inside ? 2 : 1) * way / optics.color_depth;
    const Vec3 tint =
        entered[k]->albedo.unaryExpr([&](float c) { return std::pow(std::max(c, 0.02f), colored); });
    lets[left] = passages[k].ray;
    shades[left] = passages[k].ends_inside ? let_through : k_clear_shade;
    tints[left] = let_through * tint.cwiseProduct(tints[k]);
    let_place[left++] = let_place[k];
  }
  let_count = left;
  incoming({mirrors.data(), mirror_count}, k_all_shade, {from.data(), mirror_count});
  for (std::size_t k = 0; k < mirror_count; ++k)
    light[mirror_place[k]]->beyond() += shares[k].cwiseProduct(from[k]).array();
  incoming({lets.data(), let_count}, shades, {from.data(), let_count});
  for (std::size_t k = 0; k < let_count; ++k)
    light[let_place[k]]->beyond() += tints[k].cwiseProduct(from[k]).array();
}

void World::pass_through(std::span<const Surfel* const> at, std::span<Passage> passages) const {
  std::array<Ray, k_batch> rays;
  std::array<std::uint8_t, k_batch> place;
  std::array<Bodies::Exit, k_batch> exits;
  std::array<Ray, k_batch> onward;
  std::array<float, k_batch> gaps;
  std::array<std::optional<Bodies::Hit>, k_batch> wetted;
  std::size_t count = passages.size();
  for (std::size_t i = 0; i < count; ++i) {
    place[i] = static_cast<std::uint8_t>(i);
    passages[i].way = 0;
    passages[i].ends_inside = false;
  }
  for (int bounce = 0; bounce <= k_inner_bounces && count > 0; ++bounce) {
    for (std::size_t k = 0; k < count; ++k) rays[k] = passages[place[k]].ray;
    bodies_.exits({rays.data(), count}, exits);
    for (std::size_t k = 0; k < count; ++k) {
      const Bodies::Exit& exit = exits[k];
      const bool leaves = exit.t < k_far && !exit.enters;
      onward[k] = leaves ? Ray{rays[k].at(exit.t) - epsilon_ * exit.normal, rays[k].direction} : rays[k];
      gaps[k] = leaves ? k_wetted * view_size_ / -exit.normal.dot(rays[k].direction) : -1;
    }
    bodies_.nearest({onward.data(), count}, {gaps.data(), count}, {wetted.data(), count}, Rays::scattered);
    std::size_t left = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Bodies::Exit& exit = exits[k];
      Passage& passage = passages[place[k]];
      if (exit.t == k_far) {
        if (bounce == 0) passage.way = k_far;  // a leaf without an inside
        continue;
      }
      const Solid solid = solid_on(rays[k]);
      const float beyond = (exit.t - solid.t) * -solid.normal.dot(rays[k].direction);
      if (solid.t < k_far && beyond > -k_wetted * view_size_) {
        passage.way += solid.t;
        passage.ray.origin = rays[k].at(solid.t) + epsilon_ * solid.normal;
        passage.ends_inside = true;
        continue;
      }
      passage.way += exit.t;
      const Vec3 leaves = rays[k].at(exit.t);
      if (exit.enters || wetted[k]) {
        passage.ray.origin = wetted[k] ? Vec3(onward[k].at(wetted[k]->t) + epsilon_ * wetted[k]->face)
                                       : Vec3(leaves + epsilon_ * exit.normal);
        passage.ends_inside = true;
        continue;
      }
      passage.ray.origin = onward[k].origin;
      const Optics& optics = optics_of(at[place[k]]->look);
      if (const auto out = refracted(rays[k].direction, exit.normal, optics.index)) {
        passage.ray.direction = *out;
      } else if (bounce < k_inner_bounces && passage.way < optics.free_path * view_size_ * k_opaque) {
        passage.ray = {leaves + epsilon_ * exit.normal, reflected(rays[k].direction, exit.normal)};
        place[left++] = place[k];
      }
    }
    count = left;
  }
}

Vec3 World::open_color(const Ray& ray, const Surfel& at) const {
  const Vec3 backdrop = environment_.backdrop(ray.direction);
  return at.look == Look::none ? backdrop : mix(environment_.open_floor(), backdrop, at.fade);
}

Vec3 World::color(const Ray& ray, const Surfel& at, const Light& light) const {
  if (at.look == Look::none && at.veil.cover == 0) return environment_.backdrop(ray.direction);
  Vec3 color;
  if (at.look == Look::none) {
    color = environment_.backdrop(ray.direction);
  } else {
    const Vec3 ambient = at.look == Look::floor ? floor_ambient_ : environment_.ambient(at.normal);
    color = shade(environment_, {at.look, at.albedo, at.normal, -ray.direction}, ambient, light);
    if (at.fade > 0) color = mix(color, environment_.backdrop(ray.direction), at.fade);
  }
  return color + (Vec3::Constant(at.veil.light) - color) * at.veil.cover;
}

}  // namespace mallow::render

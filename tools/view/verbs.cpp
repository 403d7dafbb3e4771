#include "view/verbs.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace mallow::view {
namespace {

float inside(const Vec3& x, const Vec3& middle, float radius) {
  const float share = (x - middle).squaredNorm() / (radius * radius);
  return share < 1 ? (1 - share) * (1 - share) : 0;
}

/// Mass of a particle of a body [kg].
double particle_mass(const Simulation& simulation, BodyId body) {
  const Simulation::Rows rows = simulation.rows(body);
  return simulation.motion(body).mass / static_cast<double>(std::max<std::size_t>(1, rows.end - rows.begin));
}

std::string count_text(std::size_t count, const char* what) {
  return std::to_string(count) + (count == 1 ? " particle " : " particles ") + what;
}

}  // namespace

BodyHit hit_of(const Simulation& simulation, const Ray& ray) {
  const auto hit = simulation.raycast(ray.origin, ray.direction);
  if (!hit) throw ConfigError("mouse", "there is no matter under the mouse");
  return *hit;
}

std::optional<std::size_t> row_of(const Simulation& simulation, ParticleId id) {
  try {
    return simulation.row(id);
  } catch (const ConfigError&) {
    return std::nullopt;
  }
}

float reach_of(const Simulation& simulation) {
  float spacing = std::numeric_limits<float>::max(), size = 0;
  for (const BodyId body : simulation.bodies()) {
    const Aabb box = simulation.bounds(body);
    spacing = std::min(spacing, simulation.spacing(body));
    size = std::max(size, (box.max - box.min).maxCoeff());
  }
  return size > 0 ? std::max(3 * spacing, size / 7) : 1;
}

BodyId throw_ball(Simulation& simulation, MaterialId material, const Ray& ray, float spacing,
                  const Throw& ball) {
  Body body = sample(sphere_shape({0, 0, 0}, ball.radius), {.spacing = spacing});
  // It starts a little before the eye, where there is room.
  const Vec3 start = ray.origin + 2 * ball.radius * ray.direction;
  for (Vec3& x : body.positions) x += start;
  body.velocity = ball.speed * ray.direction;
  int number = 1;
  const auto name = [&] { return "ball " + std::to_string(number); };
  while (simulation.find_body(name())) ++number;
  return simulation.add_body(body, material, name());
}

std::string poke(Simulation& simulation, const Ray& ray, float radius, float speed) {
  const BodyHit hit = hit_of(simulation, ray);
  double mass = 0;
  const VectorView positions = simulation.positions();
  for (const ParticleId id : simulation.particles_in(hit.position, radius))
    mass += static_cast<double>(inside(positions[simulation.row(id)], hit.position, radius)) *
            particle_mass(simulation, hit.body);
  const Vec3 impulse = ray.direction * static_cast<float>(static_cast<double>(speed) * mass);
  return "poked " + count_text(simulation.add_impulse(hit.position, radius, impulse), "");
}

std::string cut(Simulation& simulation, const Ray& from, const Ray& to) {
  const Vec3 across = from.direction.cross(to.direction);
  if (across.norm() < 1e-4f) throw ConfigError("cut", "draw a longer line");
  const Vec3 normal = across.normalized();
  const Vec3 start = normal.cross(from.direction), end = to.direction.cross(normal);
  const float side = start.dot(to.direction) < 0 ? -1.0f : 1.0f;
  std::vector<ParticleId> gone;
  const VectorView positions = simulation.positions();
  const auto ids = simulation.ids();
  for (const BodyId body : simulation.bodies()) {
    const float half = 1.1f * simulation.spacing(body);
    const Simulation::Rows rows = simulation.rows(body);
    for (std::size_t row = rows.begin; row < rows.end; ++row) {
      const Vec3 x = positions[row] - from.origin;
      if (std::abs(x.dot(normal)) > half || x.dot(from.direction) < 0) continue;
      if (side * x.dot(start) < 0 || side * x.dot(end) < 0) continue;
      gone.push_back(ids[row]);
    }
  }
  if (gone.empty()) throw ConfigError("cut", "the line meets no matter");
  std::ranges::sort(gone);
  simulation.remove_particles(gone);
  return "cut: " + count_text(gone.size(), "of a layer two spacings thick are gone");
}

std::string heat(Simulation& simulation, const Ray& ray, float radius, float kelvins, float softer) {
  const BodyHit hit = hit_of(simulation, ray);
  const std::vector<ParticleId> ids = simulation.particles_in(hit.position, radius);
  const bool carries_heat =
      simulation.material_settings(simulation.material(hit.body)).temperature.has_value();
  const VectorView positions = simulation.positions();
  const auto temperatures = simulation.temperatures();
  const Simulation::Rows rows = simulation.rows(hit.body);
  std::size_t count = 0;
  for (const ParticleId id : ids) {
    const std::size_t row = simulation.row(id);
    if (row < rows.begin || row >= rows.end) continue;
    const float share = inside(positions[row], hit.position, radius);
    const ParticleId one[] = {id};
    ++count;
    if (carries_heat)
      simulation.set_temperature(one, temperatures[row] + share * kelvins);
    else
      simulation.set_alpha(one, std::min(1.0f, simulation.alpha(id) + share * softer));
  }
  return carries_heat ? "heated " + count_text(count, "")
                      : "melted " + count_text(count, "(alpha rises, as this material carries no heat)");
}

HandPin pin(Simulation& simulation, const Ray& ray, float radius) {
  const BodyHit hit = hit_of(simulation, ray);
  std::vector<ParticleId> ids = simulation.particles_in(hit.position, radius);
  const PinId pin = simulation.pin(ids);
  return {pin, std::move(ids)};
}

}  // namespace mallow::view

#include <algorithm>
#include <cmath>
#include <sstream>

#include "colliders/collider_checks.h"
#include "config/validation.h"
#include "core/parallel.h"
#include "simulation/overlaps.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "sph/kernel_functions.h"

namespace mallow {
namespace {

/// The particles of one body share their spacing to this relative difference.
constexpr float k_same_spacing = 1e-3f;

template <class List, class Id>
auto& checked(List& list, Id id, const char* kind) {
  const auto index = static_cast<std::size_t>(id);
  if (index >= list.size())
    throw ConfigError(kind, std::string("there is no ") + kind + ' ' + std::to_string(index) +
                                "; there are " + std::to_string(list.size()));
  return list[index];
}

/// m and ρ0 of a body; what the material leaves out follows from ρ0 = m Σ W over the lattice. [model 1]
void derive_density(const SolverConfig& config, BodyState& body) {
  const double per_mass =
      lattice_density(static_cast<double>(config.support_radius), static_cast<double>(body.spacing));
  const Material& material = body.material->settings;
  if (material.particle_mass)
    body.mass = *material.particle_mass;
  else
    body.mass = material.rest_density
                    ? static_cast<float>(static_cast<double>(*material.rest_density) / per_mass)
                    : 1.0f;
  body.rest_density =
      material.rest_density.value_or(static_cast<float>(static_cast<double>(body.mass) * per_mass));
}

/// Whether two bodies act on each other as parts of one.
bool merge(const BodyState& a, const BodyState& b) {
  return a.merges && b.merges && a.material == b.material &&
         std::abs(a.spacing - b.spacing) <= k_same_spacing * a.spacing;
}

}  // namespace

void describe_bodies(Simulation::State& state) {
  Sph& sph = state.sph;
  sph.groups.clear();
  sph.bodies.clear();
  sph.viscous = false;
  sph.apart = state.config.contact == BodyContact::constraint;
  double volume = 0;
  std::vector<const BodyState*> merging;  // the first of each group that merges
  for (BodyState& body : state.bodies) {
    volume += static_cast<double>(body.size()) * std::pow(static_cast<double>(body.spacing), 3);
    sph.viscous = sph.viscous || body.viscosity > 0;
    const auto known = std::ranges::find_if(merging, [&](const BodyState* one) { return merge(*one, body); });
    if (known != merging.end()) {
      body.sph_group = (*known)->sph_group;
    } else {
      body.sph_group = static_cast<std::uint32_t>(sph.groups.size());
      if (body.merges) merging.push_back(&body);
      sph.groups.push_back(
          {.mass = body.mass,
           .rest_density = body.rest_density,
           .rest_volume = body.mass / body.rest_density,
           .pressure_coefficient = 0,  // this and the two of pressure follow alpha: resolve_pressures()
           .contact_share = 1,
           .viscosity = body.viscosity,
           .cohesion = 0});
    }
    sph.bodies.push_back({body.end, body.sph_group});
  }
  sph.grid.spacing = static_cast<float>(std::cbrt(volume / static_cast<double>(state.store.size())));
}

std::string why_unknown(const ParticleStore& store, ParticleId id) {
  if (slot_of(id) < store.slots.size() && !store.slots.generation.empty())
    return "particle " + std::to_string(id) + " was removed";
  return "there is no particle " + std::to_string(id) + "; ids are 0 to " +
         std::to_string(static_cast<std::int64_t>(store.slots.size()) - 1);
}

const BodyState& Simulation::State::body(BodyId id) const {
  return checked(bodies, id, "body");
}

void Simulation::State::refuse_in_callback() const {
  if (in_force_callback)
    throw ConfigError("force", "a callback may not change or step the simulation that calls it");
}

Simulation::Simulation(const SolverConfig& config) : state_(std::make_unique<State>()) {
  Checks checks;
  check(config, checks);
  checks.finish();
  state_->config = config;
  state_->execution.threads = Threads(config.threads, config.executor);
  state_->execution.level = config.instruction_level.value_or(best_instruction_level());
  state_->sph.support_radius = config.support_radius;
  state_->sph.formulation = config.formulation;
  state_->sph.neighbor_slack = config.neighbor_slack;
  state_->sph.factors = kernel_factors(static_cast<double>(config.support_radius));
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

MaterialId Simulation::add_material(const Material& material, std::string name) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  check(material, checks);
  checks.finish();
  check_stiffness(s.config, material, checks);
  checks.finish();
  if (name.empty()) name = "material " + std::to_string(s.materials.size());
  const auto number = static_cast<std::uint32_t>(s.materials.size());
  s.materials.push_back({.name = std::move(name), .number = number, .settings = material});
  s.prepared = false;
  return MaterialId{number};
}

namespace {

/// Puts the points of a body behind its last row. Throws ConfigError, and changes nothing.
void add_points(Simulation::State& s, const Body& points, BodyState& body) {
  const Vec3 origin = s.store.size() == 0 ? choose_origin(points) : s.origin;
  std::vector<Vec3> positions;
  positions.reserve(points.positions.size());
  for (const Vec3& x : points.positions) positions.push_back(relative_to(origin, x));
  refuse_overlaps(s, body, positions, points.spacing, origin);
  check_neighbors(s, body.material->settings, points);
  std::vector<Vec3> velocities(points.positions.size(), points.velocity);
  for (std::size_t i = 0; i < points.velocities.size(); ++i) velocities[i] += points.velocities[i];
  if (s.store.size() == 0) s.origin = origin;
  s.store.insert(body.end, positions, velocities);
  body.end += positions.size();
  body.grew = true;
  s.prepared = false;
  s.sph_ran = false;
  s.far_step = -1;
}

}  // namespace

BodyId Simulation::add_body(const Body& points, MaterialId id, std::string name) {
  state_->refuse_in_callback();
  State& s = *state_;
  MaterialState& material = checked(s.materials, id, "material");
  Checks checks;
  check(points, checks);
  checks.finish();
  BodyState body;
  body.name = name.empty() ? "body " + std::to_string(s.bodies.size()) : std::move(name);
  body.material = &material;
  body.merges = points.merges;
  body.begin = body.end = s.store.size();
  body.spacing = points.spacing;
  body.shape.region_radius = material.settings.region_radius.value_or(s.config.support_radius);
  body.shape.region_stride = material.settings.region_stride;
  derive_density(s.config, body);
  add_points(s, points, body);
  s.bodies.push_back(std::move(body));
  return static_cast<BodyId>(s.bodies.size() - 1);
}

BodyId Simulation::add_body(const Body& points, const Material& material, std::string name) {
  Checks checks;
  check(points, checks);
  checks.finish();
  const bool was_prepared = state_->prepared;
  const MaterialId id = add_material(material, name);
  try {
    return add_body(points, id, std::move(name));
  } catch (...) {
    state_->materials.pop_back();
    state_->prepared = was_prepared;
    throw;
  }
}

void Simulation::extend_body(BodyId id, const Body& points) {
  state_->refuse_in_callback();
  State& s = *state_;
  BodyState& body = checked(s.bodies, id, "body");
  Checks checks;
  check(points, checks);
  if (!(std::abs(points.spacing - body.spacing) <= k_same_spacing * body.spacing)) {
    std::ostringstream text;
    text << points.spacing << " is not allowed in body '" << body.name << "', whose spacing is "
         << body.spacing << ": all particles of a body share one spacing";
    checks.problem("body.spacing", text.str());
  }
  checks.finish();
  add_points(s, points, body);
  for (std::size_t b = static_cast<std::size_t>(id) + 1; b < s.bodies.size(); ++b) {
    s.bodies[b].begin += points.positions.size();
    s.bodies[b].end += points.positions.size();
  }
}

ColliderId Simulation::add_collider(const Collider& collider) {
  state_->refuse_in_callback();
  Checks checks;
  check(collider, checks);
  checks.finish();
  state_->colliders.push_back(collider);
  Collider& added = state_->colliders.back();
  if (!added.keyframes.empty()) added.pose = pose_at(added.keyframes, state_->time);
  return static_cast<ColliderId>(state_->colliders.size() - 1);
}

PinId Simulation::pin(const Aabb& region, const Vec3& velocity) {
  std::vector<ParticleId> ids;
  for (std::size_t row = 0; row < state_->store.size(); ++row) {
    const Vec3 x = state_->far(state_->store.position.get(row));
    if ((x.array() >= region.min.array()).all() && (x.array() <= region.max.array()).all())
      ids.push_back(state_->store.id[row]);
  }
  if (ids.empty()) {
    std::ostringstream text;
    text << "no particle is between (" << region.min.transpose() << ") and (" << region.max.transpose()
         << ')';
    throw ConfigError("pin.box", text.str());
  }
  return pin(ids, velocity);
}

PinId Simulation::pin(std::span<const ParticleId> ids, const Vec3& velocity) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  checks.vector("pin.velocity", velocity);
  std::vector<std::size_t> rows;
  for (const ParticleId id : ids) {
    if (const std::optional<std::size_t> row = s.store.slots.find(id)) {
      rows.push_back(*row);
      continue;
    }
    checks.problem("pin", why_unknown(s.store, id));
    break;
  }
  if (s.pin_velocities.size() == k_max_pins) checks.problem("pin", "at most 65535 pins are possible");
  checks.finish();
  s.pin_velocities.push_back(velocity);
  if (s.store.pin.empty()) s.store.pin.resize(s.store.size());
  for (const std::size_t row : rows) s.store.pin[row] = static_cast<std::uint16_t>(s.pin_velocities.size());
  return static_cast<PinId>(s.pin_velocities.size() - 1);
}

void Simulation::set_force(ForceCallback callback) {
  state_->refuse_in_callback();
  state_->force = std::move(callback);
  if (!state_->force) state_->user_acceleration.release();
}

void Simulation::set_alpha(MaterialId id, const AlphaSchedule& alpha) {
  state_->refuse_in_callback();
  State& s = *state_;
  MaterialState& material = checked(s.materials, id, "material");
  Checks checks;
  check(alpha, checks);
  checks.finish();
  Material changed = material.settings;
  changed.alpha = alpha;
  check_stiffness(s.config, changed, checks);
  checks.finish();
  material.settings.alpha = alpha;
  for (BodyState& body : s.bodies) {
    if (body.material != &material) continue;
    if (!body.keeps_reference()) {
      // Rows of fluids are sorted, which a reference shape that is kept would not follow.
      ShapeMatching none;
      none.region_radius = body.shape.region_radius;
      none.region_stride = body.shape.region_stride;
      body.shape = std::move(none);
    }
    // A fluid that may turn elastic remembers the shape it has now.
    if (body.keeps_reference() && body.shape.reference.size() != body.size()) {
      body.grew = true;
      s.prepared = false;
    }
  }
}

void Simulation::set_velocity(ColliderId id, const Vec3& velocity) {
  set_twist(id, velocity, collider(id).angular_velocity);
}

void Simulation::set_twist(ColliderId id, const Vec3& velocity, const Vec3& angular_velocity) {
  state_->refuse_in_callback();
  collider(id);
  Checks checks;
  checks.vector("collider.velocity", velocity);
  checks.vector("collider.angular_velocity", angular_velocity);
  checks.finish();
  Collider& changed = state_->colliders[static_cast<std::size_t>(id)];
  changed.velocity = velocity;
  changed.angular_velocity = angular_velocity;
  changed.keyframes.clear();
}

void Simulation::set_pose(ColliderId id, const Pose& pose, double seconds) {
  state_->refuse_in_callback();
  collider(id);
  Checks checks;
  check_pose("collider.pose", pose, checks);
  checks.number("seconds", seconds, seconds >= 0, "a number >= 0");
  checks.finish();
  Collider& changed = state_->colliders[static_cast<std::size_t>(id)];
  changed.velocity.setZero();
  changed.angular_velocity.setZero();
  changed.keyframes.clear();
  if (seconds > 0)
    changed.keyframes = {{state_->time, changed.pose}, {state_->time + seconds, pose}};
  else
    changed.pose = pose;
}

void Simulation::set_velocity(PinId id, const Vec3& velocity) {
  state_->refuse_in_callback();
  Checks checks;
  checks.vector("pin.velocity", velocity);
  if (static_cast<std::size_t>(id) >= state_->pin_velocities.size())
    checks.problem("pin", "there is no pin " + std::to_string(static_cast<std::size_t>(id)));
  checks.finish();
  state_->pin_velocities[static_cast<std::size_t>(id)] = velocity;
}

void Simulation::prepare() {
  state_->refuse_in_callback();
  State& s = *state_;
  if (s.prepared) return;
  Checks checks;
  if (s.store.size() == 0) checks.problem("body", "no particles: a simulation needs at least one");
  checks.finish();
  resolve_settings(s);
  check_memory(s);

  s.sph.kept.forget();
  describe_bodies(s);
  for (BodyState& body : s.bodies) {
    if (body.grew && body.keeps_reference()) {
      take_reference(s, body);
      const Eigen::Vector3d near = s.store.position.get(body.begin).cast<double>();
      body.rigid =
          rigid_motion(sum_rigid(s.store.position, s.store.velocity, body.begin, body.end, near), near);
    }
    body.grew = false;
  }
  read_alphas(s);
  for (BodyState& body : s.bodies)
    if (body.matches_shape() && !body.shape.built) build_regions(s.execution, s.region_scratch, body.shape);
  s.prepared = true;
}

}  // namespace mallow

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/parallel.h"
#include "simulation/overlaps.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/validation.h"
#include "sph/kernel_functions.h"

namespace mallow {
namespace {

/// Bodies of one group share their spacing to this relative difference.
constexpr float k_same_spacing = 1e-3f;

Group& checked(std::vector<Group>& groups, GroupId id) {
  const auto index = static_cast<std::size_t>(id);
  if (index >= groups.size())
    throw ConfigError("group", "there is no group " + std::to_string(index) +
                                   "; groups so far: " + std::to_string(groups.size()));
  return groups[index];
}

void normalize(Plane& plane) {
  const float length = plane.normal.norm();
  plane.normal /= length;
  plane.offset /= length;
}
void normalize(Sphere&) {}
void normalize(Box&) {}
void normalize(Union& shapes) {
  for (Primitive& part : shapes.parts) std::visit([](auto& shape) { normalize(shape); }, part);
}

/// m and ρ0 of a group; what the material leaves out follows from ρ0 = m Σ W over the lattice. [model 1]
void derive_density(const SolverConfig& config, Group& group) {
  const double per_mass =
      lattice_density(static_cast<double>(config.support_radius), static_cast<double>(group.spacing));
  const Material& material = group.material;
  if (material.particle_mass)
    group.mass = *material.particle_mass;
  else
    group.mass = material.rest_density
                     ? static_cast<float>(static_cast<double>(*material.rest_density) / per_mass)
                     : 1.0f;
  group.rest_density =
      material.rest_density.value_or(static_cast<float>(static_cast<double>(group.mass) * per_mass));
}

/// Colliders that are there already are seen from the origin too.
void take_origin(Simulation::State& state, const Vec3& origin) {
  state.origin = origin;
  state.near_colliders.clear();
  if (!state.is_far()) return;
  for (const Collider& collider : state.colliders)
    state.near_colliders.push_back(relative_to(origin, collider));
}

}  // namespace

void describe_groups(Simulation::State& state) {
  Sph& sph = state.sph;
  sph.groups.clear();
  sph.group_end.clear();
  sph.viscous = false;
  double volume = 0;
  for (const Group& group : state.groups) {
    volume += static_cast<double>(group.size()) * std::pow(static_cast<double>(group.spacing), 3);
    sph.groups.push_back(
        {.mass = group.mass,
         .rest_density = group.rest_density,
         .rest_volume = group.mass / group.rest_density,
         .pressure_coefficient = 0,  // this and the two of pressure follow alpha: resolve_pressures()
         .contact_share = 1,
         .viscosity = group.viscosity,
         .cohesion = 0});
    sph.group_end.push_back(group.end);
    sph.viscous = sph.viscous || group.viscosity > 0;
  }
  sph.grid.spacing = static_cast<float>(std::cbrt(volume / static_cast<double>(state.store.size())));
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
  state_->threads = Threads(config.threads, config.executor);
  state_->level = config.instruction_level.value_or(best_instruction_level());
  state_->sph.support_radius = config.support_radius;
  state_->sph.formulation = config.formulation;
  state_->sph.neighbor_slack = config.neighbor_slack;
  state_->sph.factors = kernel_factors(static_cast<double>(config.support_radius));
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

GroupId Simulation::add_group(const Material& material, std::string name) {
  state_->refuse_in_callback();
  Checks checks;
  check(material, checks);
  checks.finish();
  check_stiffness(state_->config, material, checks);
  checks.finish();
  State& s = *state_;
  if (s.groups.size() == k_max_groups) throw ConfigError("group", "at most 256 groups are possible");
  Group group;
  group.name = name.empty() ? "group " + std::to_string(s.groups.size()) : std::move(name);
  group.material = material;
  group.begin = group.end = s.store.size();
  group.shape.region_radius = material.region_radius.value_or(s.config.support_radius);
  group.shape.region_stride = material.region_stride;
  s.groups.push_back(std::move(group));
  s.prepared = false;
  return static_cast<GroupId>(s.groups.size() - 1);
}

void Simulation::add_body(const Body& body, GroupId id) {
  state_->refuse_in_callback();
  State& s = *state_;
  Group& group = checked(s.groups, id);
  Checks checks;
  check(body, checks);
  if (group.spacing > 0 && !(std::abs(body.spacing - group.spacing) <= k_same_spacing * group.spacing)) {
    std::ostringstream text;
    text << body.spacing << " is not allowed in group '" << group.name << "', whose spacing is "
         << group.spacing << ": bodies of one group share one spacing";
    checks.problem("body.spacing", text.str());
  }
  checks.finish();
  const Vec3 origin = s.store.size() == 0 ? choose_origin(body) : s.origin;
  std::vector<Vec3> positions;
  positions.reserve(body.positions.size());
  for (const Vec3& x : body.positions) positions.push_back(relative_to(origin, x));
  refuse_overlaps(s, group, positions, body.spacing, origin);
  check_neighbors(s, group, body);
  std::vector<Vec3> velocities(body.positions.size(), body.velocity);
  for (std::size_t i = 0; i < body.velocities.size(); ++i) velocities[i] += body.velocities[i];
  if (s.store.size() == 0) take_origin(s, origin);
  s.store.insert(group.end, positions, velocities);
  group.end += body.positions.size();
  for (std::size_t g = static_cast<std::size_t>(id) + 1; g < s.groups.size(); ++g) {
    s.groups[g].begin += body.positions.size();
    s.groups[g].end += body.positions.size();
  }
  if (group.spacing == 0) group.spacing = body.spacing;
  derive_density(s.config, group);
  group.grew = true;
  s.prepared = false;
  s.sph_ran = false;
  s.far_step = -1;
}

GroupId Simulation::add_body(const Body& body, const Material& material, std::string name) {
  Checks checks;
  check(body, checks);
  checks.finish();
  const bool was_prepared = state_->prepared;
  const GroupId group = add_group(material, std::move(name));
  try {
    add_body(body, group);
  } catch (...) {
    state_->groups.pop_back();
    state_->prepared = was_prepared;
    throw;
  }
  return group;
}

ColliderId Simulation::add_collider(const Collider& collider) {
  state_->refuse_in_callback();
  Checks checks;
  check(collider, checks);
  checks.finish();
  state_->colliders.push_back(collider);
  std::visit([](auto& shape) { normalize(shape); }, state_->colliders.back().shape);
  if (state_->is_far())
    state_->near_colliders.push_back(relative_to(state_->origin, state_->colliders.back()));
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
  for (const ParticleId id : ids) {
    if (id < s.store.size()) continue;
    checks.problem("pin", "there is no particle " + std::to_string(id) + "; ids are 0 to " +
                              std::to_string(static_cast<std::int64_t>(s.store.size()) - 1));
    break;
  }
  if (s.pin_velocities.size() == k_max_pins) checks.problem("pin", "at most 65535 pins are possible");
  checks.finish();
  s.pin_velocities.push_back(velocity);
  if (s.store.pin.empty()) s.store.pin.resize(s.store.size());
  for (const ParticleId id : ids)
    s.store.pin[s.store.row_of_id[id]] = static_cast<std::uint16_t>(s.pin_velocities.size());
  return static_cast<PinId>(s.pin_velocities.size() - 1);
}

void Simulation::set_force(ForceCallback callback) {
  state_->refuse_in_callback();
  state_->force = std::move(callback);
  if (!state_->force) state_->user_acceleration.release();
}

void Simulation::set_alpha(GroupId id, const AlphaSchedule& alpha) {
  state_->refuse_in_callback();
  Group& group = checked(state_->groups, id);
  Checks checks;
  check(alpha, checks);
  checks.finish();
  Material changed = group.material;
  changed.alpha = alpha;
  check_stiffness(state_->config, changed, checks);
  checks.finish();
  group.material.alpha = alpha;
  if (!group.keeps_reference()) {
    // Rows of fluids are sorted, which a reference shape that is kept would not follow.
    ShapeMatching none;
    none.region_radius = group.shape.region_radius;
    none.region_stride = group.shape.region_stride;
    group.shape = std::move(none);
  }
  // A fluid that may turn elastic remembers the shape it has now.
  if (group.keeps_reference() && group.shape.reference.size() != group.size()) {
    group.grew = true;
    state_->prepared = false;
  }
}

void Simulation::set_velocity(ColliderId id, const Vec3& velocity) {
  state_->refuse_in_callback();
  Checks checks;
  checks.vector("collider.velocity", velocity);
  if (static_cast<std::size_t>(id) >= state_->colliders.size())
    checks.problem("collider", "there is no collider " + std::to_string(static_cast<std::size_t>(id)));
  checks.finish();
  state_->colliders[static_cast<std::size_t>(id)].velocity = velocity;
  if (state_->is_far()) state_->near_colliders[static_cast<std::size_t>(id)].velocity = velocity;
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
  for (const Group& group : s.groups)
    if (group.size() == 0) checks.problem("group", "group '" + group.name + "' has no particles");
  checks.finish();
  resolve_settings(s);
  check_memory(s);

  s.sph.kept.forget();
  describe_groups(s);
  for (Group& group : s.groups) {
    if (group.grew && group.keeps_reference()) take_reference(s, group);
    group.grew = false;
  }
  read_alphas(s);
  for (Group& group : s.groups)
    if (group.matches_shape() && !group.shape.built)
      build_regions(s.threads, s.level, s.region_scratch, group.shape);
  s.prepared = true;
}

}  // namespace mallow

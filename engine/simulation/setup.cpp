#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "colliders/collider_checks.h"
#include "config/validation.h"
#include "core/parallel.h"
#include "simulation/membership.h"
#include "simulation/overlaps.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "sph/kernel_functions.h"

namespace mallow {
namespace {

/// The particles of one body share their spacing to this relative difference.
constexpr float k_same_spacing = 1e-3f;

/// Whether two bodies may be parts of one.
bool merge(const BodyState& a, const BodyState& b) {
  return a.merges && b.merges && a.material == b.material &&
         std::abs(a.spacing - b.spacing) <= k_same_spacing * a.spacing;
}

/// The first body of each group of those that may be one, by material and spacing: few are looked at for a
/// body, however many there are.
class FirstBodies {
 public:
  /// The earliest that the body may be part of; null: there is none, and the body is one of them now.
  const BodyState* like(const BodyState& body) {
    if (!body.merges) return nullptr;
    const std::uint32_t material = slot_of(body.material->id);
    const float margin = 2 * k_same_spacing * body.spacing;
    const First* first = nullptr;
    for (auto one = firsts_.lower_bound({material, body.spacing - margin});
         one != firsts_.end() && one->first <= Key{material, body.spacing + margin}; ++one)
      if (merge(*one->second.body, body) && (!first || one->second.place < first->place))
        first = &one->second;
    if (first) return first->body;
    firsts_.emplace(Key{material, body.spacing}, First{&body, firsts_.size()});
    return nullptr;
  }

 private:
  using Key = std::pair<std::uint32_t, float>;
  struct First {
    const BodyState* body;
    std::size_t place;  ///< among the firsts
  };
  std::map<Key, First> firsts_;
};

/// Of a particle in densities: its lattice has the same by either kernel.
float kernel_volume(const Sph& sph, const BodyState& body) {
  const float volume = body.mass / body.rest_density;
  if (sph.kernel == DensityKernel::poly6) return volume;
  const double radius = static_cast<double>(sph.support_radius), h = static_cast<double>(body.spacing);
  const double factor = static_cast<double>(sph.factors.density);
  return static_cast<float>(static_cast<double>(volume) * lattice_density(radius, h) /
                            (factor * wendland_lattice_sum(radius, h)));
}

}  // namespace

ParticleDensity particle_density(const SolverConfig& config, const Material& material, float spacing) {
  const double per_mass =
      lattice_density(static_cast<double>(support_radius(config, spacing)), static_cast<double>(spacing));
  ParticleDensity density{.mass = 1, .rest_density = 0};
  if (material.particle_mass)
    density.mass = *material.particle_mass;
  else if (material.rest_density)
    density.mass = static_cast<float>(static_cast<double>(*material.rest_density) / per_mass);
  density.rest_density =
      material.rest_density.value_or(static_cast<float>(static_cast<double>(density.mass) * per_mass));
  return density;
}

void derive_density(const SolverConfig& config, BodyState& body) {
  const ParticleDensity density = particle_density(config, body.material->settings, body.spacing);
  body.mass = density.mass;
  body.rest_density = density.rest_density;
}

float support_radius(const SolverConfig& config, float spacing) {
  return config.support_radius.value_or(default_support_radius(spacing));
}

float region_radius(const SolverConfig& config, const Material& material, float spacing) {
  return material.region_radius.value_or(support_radius(config, spacing));
}

void take_support_radius(Simulation::State& state) {
  state.sph.support_radius = state.support_radius();
  state.sph.factors = kernel_factors(static_cast<double>(state.support_radius()));
}

void measure_rigid(const Simulation::State& s, BodyState& body) {
  const Eigen::Vector3d near = s.store.position.get(body.begin).cast<double>();
  const RigidSums sums =
      sum_rigid(s.execution.level, raw(s.store.position), raw(s.store.velocity), body.begin, body.end, near);
  body.rigid = rigid_motion(sums, near);
}

void describe_bodies(Simulation::State& state) {
  Sph& sph = state.sph;
  sph.groups.clear();
  state.volume.groups.clear();
  sph.bodies.clear();
  sph.viscous = false;
  sph.apart = state.config.contact == BodyContact::constraint;
  const bool keeps_volume = state.volume_iterations() > 0;
  sph.kernel = keeps_volume ? DensityKernel::wendland : DensityKernel::poly6;
  double volume = 0;
  FirstBodies merging, flowing;
  std::uint32_t merge_groups = 0;
  for (BodyState& body : state.bodies) {
    volume += static_cast<double>(body.size()) * std::pow(static_cast<double>(body.spacing), 3);
    sph.viscous = sph.viscous || body.viscosity > 0;
    const BodyState* merges_with = merging.like(body);
    body.merge_group = merges_with ? merges_with->merge_group : merge_groups++;
    const BodyState* flows_with = body.touches_what_it_merges_with() ? nullptr : flowing.like(body);
    if (flows_with) {
      body.sph_group = flows_with->sph_group;
    } else {
      body.sph_group = static_cast<std::uint32_t>(sph.groups.size());
      sph.groups.push_back(
          {.mass = body.mass,
           .rest_density = body.rest_density,
           .rest_volume = body.mass / body.rest_density,
           .kernel_volume = kernel_volume(sph, body),
           .pressure_coefficient = 0,  // this and the two of pressure follow alpha: resolve_pressures()
           .contact_share = 1,
           .viscosity = body.viscosity,
           .cohesion = 0});
      if (keeps_volume)
        state.volume.groups.push_back(volume_group(sph.groups.back(), body.spacing, sph.support_radius));
    }
    sph.bodies.push_back({body.end, body.sph_group});
  }
  const std::size_t particles = std::max(state.store.size(), std::size_t{1});
  sph.grid.spacing = static_cast<float>(std::cbrt(volume / static_cast<double>(particles)));
  // Bodies of one group sleep together.
  sph.grid.anchored = state.bodies_sleep() && sph.groups.size() > 1;
}

std::string why_unknown(const ParticleStore& store, ParticleId id) {
  if (slot_of(id) < store.slots.size() && !store.slots.generation.empty())
    return "particle " + std::to_string(id) + " was removed";
  return "there is no particle " + std::to_string(id) + "; ids are 0 to " +
         std::to_string(static_cast<std::int64_t>(store.slots.size()) - 1);
}

void refuse_id(const char* kind, std::uint64_t id, const Slots& slots) {
  const std::string name = std::string(kind) + ' ' + std::to_string(id);
  if (slot_of(id) < slots.size() && !slots.generation.empty()) throw ConfigError(kind, name + " was removed");
  throw ConfigError(
      kind, "there is no " + name + "; there are " + std::to_string(slots.size() - slots.free.size()));
}

const BodyState& Simulation::State::body(BodyId id) const {
  const auto number = static_cast<std::uint64_t>(id);
  if (const std::optional<std::size_t> index = body_slots.find(number)) return bodies[*index];
  if (const auto gone = std::ranges::find(ended, number, &EndedBody::id); gone != ended.end())
    throw ConfigError("body", "body " + std::to_string(number) + " was merged into body " +
                                  std::to_string(static_cast<std::uint64_t>(gone->part_of)));
  refuse_id("body", number, body_slots);
}

std::size_t Simulation::State::index(ColliderId id) const {
  const auto number = static_cast<std::uint64_t>(id);
  if (const std::optional<std::size_t> index = collider_slots.find(number)) return *index;
  refuse_id("collider", number, collider_slots);
}

PinState& Simulation::State::pin(PinId id) {
  const auto number = static_cast<std::uint64_t>(id);
  if (const std::optional<std::size_t> index = pin_slots.find(number)) return pins[*index];
  refuse_id("pin", number, pin_slots);
}

MaterialState& Simulation::State::material(MaterialId id) {
  const auto number = static_cast<std::uint64_t>(id);
  if (const std::optional<std::size_t> index = material_slots.find(number)) return materials[*index];
  refuse_id("material", number, material_slots);
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
  if (config.support_radius) take_support_radius(*state_);
  state_->sph.formulation = config.formulation;
  state_->sph.neighbor_slack = config.neighbor_slack;
  state_->sph.native = config.arithmetic == Arithmetic::native;
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

MaterialState checked_material(const Simulation::State& s, const Material& material, std::string name) {
  Checks checks;
  check(material, checks);
  checks.finish();
  check_stiffness(s.config, material, {}, checks);
  checks.finish();
  if (name.empty()) name = "material " + std::to_string(s.material_slots.given());
  return {.name = std::move(name), .settings = material};
}

MaterialState& keep_material(Simulation::State& s, MaterialState material) {
  material.id = MaterialId{s.material_slots.take()};
  const std::uint32_t slot = slot_of(material.id);
  s.material_slots.index[slot] = slot;
  s.materials.resize(s.material_slots.size());
  s.materials[slot] = std::move(material);
  s.prepared = false;
  return s.materials[slot];
}

void leave_material(Simulation::State& s, MaterialState& material) {
  if (--material.bodies > 0 || material.stays) return;
  s.material_slots.give_back(static_cast<std::uint64_t>(material.id));
  material = {};
}

MaterialId Simulation::add_material(const Material& material, std::string name) {
  state_->refuse_in_callback();
  return keep_material(*state_, checked_material(*state_, material, std::move(name))).id;
}

void Simulation::prepare() {
  mallow::prepare(*state_);
}

void prepare(Simulation::State& s) {
  s.refuse_in_callback();
  if (s.prepared) return;
  if (s.store.size() == 0 && s.scale.spacing == 0) {  // nothing follows from it, and nothing is settled
    Checks checks;
    if (!s.config.time_step)
      checks.problem(
          "solver.time_step",
          "is missing, and there are no particles by whose spacing it would follow; give it, or add "
          "a body first");
    checks.finish();
    return;
  }
  const bool is_first = s.scale.spacing == 0;
  const SolverConfig given = s.config;
  try {
    resolve_settings(s);
    check_elasticities(s);
    check_memory(s);
  } catch (const ConfigError&) {
    if (is_first) {  // whoever mends it may mean another scale
      s.config = given;
      s.scale = {.spacing = 0};
    }
    throw;
  }

  s.sph.kept.forget();
  s.placed.forget();
  describe_bodies(s);
  prepare_heat(s);
  for (BodyState& body : s.bodies) {
    if (body.grew && body.keeps_reference()) {
      take_reference(s, body);
      measure_rigid(s, body);
    }
    body.grew = false;
  }
  read_alphas(s);
  for (BodyState& body : s.bodies)
    if (body.matches_shape() && !body.shape.built) build_regions(s.execution, s.region_scratch, body.shape);
  check_emitters(s);
  if (is_first) check_speeds(s);
  s.prepared = true;
}

}  // namespace mallow

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/parallel.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/stiffness.h"

namespace mallow {
namespace {

VectorView view(const VectorColumn& column) {
  return {column.x(), column.size(), column.stride()};
}

/// value(row) of every particle, in the order of slots.
template <class Value>
auto by_id(const ParticleStore& store, const Value& value) {
  std::vector<decltype(value(std::size_t{}))> values;
  values.reserve(store.size());
  for (const std::uint32_t row : store.slots.index)
    if (row != Slots::k_free) values.push_back(value(row));
  return values;
}
std::vector<Vec3> by_id(const ParticleStore& store, const VectorColumn& column) {
  return by_id(store, [&](std::size_t row) { return column.get(row); });
}

/// Mean |N_i| over the present positions of a body that has no reference shape.
double count_neighbors(const Simulation::State& s, const BodyState& body) {
  CellGrid grid;
  NeighborLists lists;
  const float radius = body.shape.region_radius;
  build_cell_grid(s.store.position, body.begin, body.end, radius, s.execution, grid);
  build_neighbor_lists(grid, radius, s.execution, lists);
  return lists.average();
}

}  // namespace

const VectorColumn& Simulation::State::seen_positions() {
  if (!is_far()) return store.position;
  if (far_step == step) return far_position;
  far_position.resize_unset(store.size());
  parallel_for(execution.threads, store.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) far_position.set(i, far(store.position.get(i)));
  });
  far_step = step;
  return far_position;
}

const char* name(Phase phase) {
  constexpr std::array<const char*, k_phase_count> k_names{
      "reference_update", "neighbors", "density", "accelerations", "time_step", "region_sums",
      "rotations",        "goals",     "volume",  "body_contact",  "motion"};
  return k_names[static_cast<std::size_t>(phase)];
}

void AdvanceReport::add(const StepReport& step) {
  ++steps;
  smallest_step = steps == 1 ? step.time_step : std::min(smallest_step, step.time_step);
  largest_step = std::max(largest_step, step.time_step);
  max_velocity = std::max(max_velocity, step.max_velocity);
  if (step.limited) ++limited_steps;
  updated_references += step.updated_references;
  drained += static_cast<std::int64_t>(step.drained);
  volume_iterations += step.volume_iterations;
  largest_compression = std::max(largest_compression, step.largest_compression);
  for (std::size_t i = 0; i < k_phase_count; ++i) seconds[i] += step.seconds[i];
}

std::size_t Simulation::particle_count() const {
  return state_->store.size();
}
std::size_t Simulation::body_count() const {
  return state_->bodies.size();
}
double Simulation::time() const {
  return state_->time;
}
std::int64_t Simulation::step_count() const {
  return state_->step;
}
const SolverConfig& Simulation::config() const {
  return state_->config;
}
const std::vector<Collider>& Simulation::colliders() const {
  return state_->colliders;
}
const Collider& Simulation::collider(ColliderId id) const {
  return state_->colliders[state_->index(id)];
}
ColliderLoad Simulation::load(ColliderId id) const {
  if (!collider(id).measure_load)
    throw ConfigError("collider.measure_load", "is false: the loads of collider " +
                                                   std::to_string(static_cast<std::uint64_t>(id)) +
                                                   " are not measured");
  const std::size_t index = state_->index(id);
  return index < state_->moving.loads.size() ? state_->moving.loads[index] : ColliderLoad{};
}

std::span<const ParticleId> Simulation::ids() const {
  return state_->store.id.span();
}
VectorView Simulation::positions() const {
  return view(state_->seen_positions());
}
VectorView Simulation::velocities() const {
  return view(state_->store.velocity);
}
std::span<const float> Simulation::densities() const {
  return state_->density_ran ? state_->sph.density_by_row.span() : std::span<const float>{};
}

Simulation::Rows Simulation::rows(BodyId id) const {
  const BodyState& body = std::as_const(*state_).body(id);
  return {body.begin, body.end};
}
float Simulation::spacing(BodyId id) const {
  return std::as_const(*state_).body(id).spacing;
}
MaterialId Simulation::material(BodyId id) const {
  return std::as_const(*state_).body(id).material->id;
}

std::size_t Simulation::row(ParticleId id) const {
  const ParticleStore& store = state_->store;
  if (const std::optional<std::size_t> row = store.slots.find(id)) return *row;
  throw ConfigError("particle", why_unknown(store, id));
}

namespace {

/// field: what was asked for, by which there is no shape to tell of.
void require_shape(const BodyState& body, const char* field, const char* subject) {
  if (body.shape.built && body.shape.reference.size() == body.size()) return;
  throw ConfigError(field, subject + ("'" + body.name) +
                               "', which has no reference shape now: its alpha is 1, or prepare() is due");
}

/// The body of a row, with a shape to tell of.
const BodyState& shaped(const Simulation::State& s, std::size_t row) {
  const BodyState& body = s.body_of(row);
  require_shape(body, "particle", "is of body ");
  return body;
}
const BodyState& shaped(const Simulation::State& s, BodyId id) {
  const BodyState& body = s.body(id);
  require_shape(body, "body", "is ");
  return body;
}

RotationView rotations_of(const BodyState& body) {
  const ShapeMatching& shape = body.shape;
  const auto& r = shape.rotation;
  const std::array columns{r[0].data(), r[1].data(), r[2].data(), r[3].data()};
  if (shape.region_stride == 1) return {columns, body.size()};
  const TableLists& lists = shape.memberships;
  return {columns, body.size(), lists.begin.data(), lists.entries.data(), lists.rows};
}

}  // namespace

Vec3 Simulation::rest_position(ParticleId id) const {
  const std::size_t at = row(id);
  const BodyState& body = shaped(*state_, at);
  return body.shape.reference.get(at - body.begin);
}

Eigen::Quaternionf Simulation::rotation(ParticleId id) const {
  const std::size_t at = row(id);
  const BodyState& body = shaped(*state_, at);
  return rotations_of(body)[at - body.begin];
}

VectorView Simulation::rest_positions(BodyId id) const {
  return view(shaped(*state_, id).shape.reference);
}

RotationView Simulation::rotations(BodyId id) const {
  return rotations_of(shaped(*state_, id));
}

std::vector<Vec3> Simulation::positions_by_id() const {
  return by_id(state_->store, state_->seen_positions());
}
std::vector<Vec3> Simulation::velocities_by_id() const {
  return by_id(state_->store, state_->store.velocity);
}

std::vector<std::uint32_t> Simulation::bodies_by_id() const {
  const State& s = *state_;
  return by_id(s.store, [&](std::size_t row) { return slot_of(s.body_of(row).id); });
}

std::uint64_t Simulation::state_hash() const {
  // Positions as they are kept: what the origin hides of them counts too.
  const std::vector<Vec3> x = by_id(state_->store, state_->store.position), v = velocities_by_id();
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  std::uint64_t hash =
      XXH3_64bits_withSeed(x.data(), x.size() * sizeof(Vec3), static_cast<XXH64_hash_t>(state_->step));
  hash = XXH3_64bits_withSeed(v.data(), v.size() * sizeof(Vec3), hash);
  if (state_->is_far()) hash = XXH3_64bits_withSeed(state_->origin.data(), sizeof(Vec3), hash);
  return XXH3_64bits_withSeed(&state_->time, sizeof(double), hash);
}

SimulationInfo Simulation::info() const {
  mallow::prepare(*state_);
  const State& s = *state_;
  SimulationInfo info;
  info.particles = s.store.size();
  info.sph = s.needs_sph();
  info.viscosity = info.sph && s.sph.viscous;
  info.cross_group = s.sph.groups.size() > 1;
  info.instruction_level = s.execution.level;
  info.bytes = s.store.bytes() + s.sph.bytes() + s.fluid_order.bytes() + s.user_acceleration.bytes() +
               s.far_position.bytes() + s.region_scratch.bytes() + s.led_position.bytes() +
               s.contact_pairs.bytes() + s.volume.bytes();
  info.support_radius = s.config.support_radius.value_or(0.0f);  // not settled where nothing has come yet
  info.time_step = s.base_step();
  info.time_step_source = s.time_step_source;
  info.longest_step = s.longest_step();
  info.update_period = update_period(s);
  info.unlimited_step = unlimited_step(s);
  info.volume_iterations = s.volume_iterations();
  info.warnings = warnings(s);
  for (const BodyState& body : s.bodies) {
    info.bytes += body.shape.bytes();
    const ShapeMatching& shape = body.shape;
    const Material& settings = body.material->settings;
    info.bodies.push_back(
        {.name = body.name,
         .material = body.material->name,
         .particles = body.size(),
         .spacing = body.spacing,
         .particle_mass = body.mass,
         .rest_density = body.rest_density,
         .region_radius = shape.region_radius,
         .alpha = body.material->alpha,
         .update_threshold = body.material->update_threshold,
         .pressure_coefficient = pressure_coefficient(s, body),
         .viscosity = body.viscosity,
         .elastic_time_step = body.elastic_time_step,
         .youngs_modulus = static_cast<float>(
             stiffness_scale(s.config, settings, body.spacing) /
             (static_cast<double>(s.base_step()) * static_cast<double>(body.elastic_time_step))),
         .most_youngs_modulus = static_cast<float>(most_modulus(s.config, settings, body.spacing)),
         .average_neighbors = shape.built ? shape.average_neighbors : count_neighbors(s, body),
         .regions = shape.built ? shape.region_weight.size() : 0,
         .shape_matching = body.matches_shape(),
         .sleep_speed = sleep_speed(s, body),
         .sleep_time = sleep_time(s, body)});
  }
  return info;
}

}  // namespace mallow

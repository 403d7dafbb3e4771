#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/parallel.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

VectorView view(const VectorColumn& column) {
  return {column.x(), column.size(), column.stride()};
}

std::vector<Vec3> by_id(const ParticleStore& store, const VectorColumn& column) {
  std::vector<Vec3> values(store.size());
  for (std::size_t id = 0; id < values.size(); ++id) values[id] = column.get(store.row_of_id[id]);
  return values;
}

/// Mean |N_i| over the present positions of a group that has no reference shape.
double count_neighbors(const Simulation::State& s, const Group& group) {
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(s.store.position, group.begin, group.end, group.shape.region_radius, s.threads, s.level,
                  grid);
  build_neighbor_lists(grid, group.shape.region_radius, s.threads, s.level, lists);
  return lists.average();
}

}  // namespace

const VectorColumn& Simulation::State::seen_positions() {
  if (!is_far()) return store.position;
  if (far_step == step) return far_position;
  far_position.resize_unset(store.size());
  parallel_for(threads, store.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) far_position.set(i, far(store.position.get(i)));
  });
  far_step = step;
  return far_position;
}

const char* name(Phase phase) {
  constexpr std::array<const char*, k_phase_count> k_names{"reference_update", "neighbors", "density",
                                                           "accelerations",    "time_step", "region_sums",
                                                           "rotations",        "goals",     "motion"};
  return k_names[static_cast<std::size_t>(phase)];
}

void AdvanceReport::add(const StepReport& step) {
  ++steps;
  smallest_step = steps == 1 ? step.time_step : std::min(smallest_step, step.time_step);
  largest_step = std::max(largest_step, step.time_step);
  max_velocity = std::max(max_velocity, step.max_velocity);
  if (step.limited) ++limited_steps;
  updated_references += step.updated_references;
  for (std::size_t i = 0; i < k_phase_count; ++i) seconds[i] += step.seconds[i];
}

std::size_t Simulation::particle_count() const {
  return state_->store.size();
}
std::size_t Simulation::group_count() const {
  return state_->groups.size();
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
  return state_->sph_ran ? state_->sph.density_by_row.span() : std::span<const float>{};
}

Simulation::Rows Simulation::rows(GroupId group) const {
  const auto index = static_cast<std::size_t>(group);
  if (index >= state_->groups.size())
    throw ConfigError("group", "there is no group " + std::to_string(index));
  return {state_->groups[index].begin, state_->groups[index].end};
}

std::vector<Vec3> Simulation::positions_by_id() const {
  return by_id(state_->store, state_->seen_positions());
}
std::vector<Vec3> Simulation::velocities_by_id() const {
  return by_id(state_->store, state_->store.velocity);
}

std::vector<std::uint8_t> Simulation::groups_by_id() const {
  std::vector<std::uint8_t> groups(state_->store.size());
  for (std::size_t g = 0; g < state_->groups.size(); ++g)
    for (std::size_t row = state_->groups[g].begin; row < state_->groups[g].end; ++row)
      groups[state_->store.id[row]] = static_cast<std::uint8_t>(g);
  return groups;
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

SimulationInfo Simulation::info() {
  prepare();
  const State& s = *state_;
  SimulationInfo info;
  info.particles = s.store.size();
  info.sph = s.needs_sph();
  info.viscosity = info.sph && s.sph.viscous;
  info.cross_group = s.groups.size() > 1;
  info.instruction_level = s.level;
  info.bytes = s.store.bytes() + s.sph.bytes() + s.fluid_order.bytes() + s.user_acceleration.bytes() +
               s.far_position.bytes() + s.region_scratch.bytes();
  info.time_step = s.base_step();
  info.time_step_source = s.time_step_source;
  info.longest_step = s.longest_step();
  info.update_period = update_period(s);
  info.unlimited_step = unlimited_step(s);
  info.warnings = warnings(s);
  for (const Group& group : s.groups) {
    info.bytes += group.shape.bytes();
    info.groups.push_back(
        {.name = group.name,
         .particles = group.size(),
         .spacing = group.spacing,
         .particle_mass = group.mass,
         .rest_density = group.rest_density,
         .region_radius = group.shape.region_radius,
         .alpha = group.alpha,
         .update_threshold = group.update_threshold,
         .pressure_coefficient = pressure_coefficient(s, group),
         .viscosity = group.viscosity,
         .average_neighbors = group.shape.built ? group.shape.average_neighbors : count_neighbors(s, group),
         .regions = group.shape.built ? group.shape.region_weight.size() : 0,
         .shape_matching = group.matches_shape()});
  }
  return info;
}

}  // namespace mallow

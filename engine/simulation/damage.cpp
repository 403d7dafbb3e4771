#include "simulation/damage.h"

#include <cmath>
#include <string_view>

#include "simulation/state.h"

namespace mallow {
namespace {

constexpr const char* k_by_force = "acceleration by the force callback";

/// Looks through one column after the other and keeps what it finds first in the earliest phase.
class Search {
 public:
  explicit Search(Phase last) : last_(last) {}

  /// row_of: entry -> row.
  template <class RowOf>
  void column(Phase phase, const char* name, std::span<const float> values, const RowOf& row_of) {
    if (phase > last_ || (found_ && found_->phase <= phase)) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) continue;
      found_ = Damage{phase, name, static_cast<std::uint32_t>(row_of(i))};
      return;
    }
  }
  template <class RowOf>
  void column(Phase phase, const char* name, const Column<float>& values, const RowOf& row_of) {
    column(phase, name, values.span(), row_of);
  }
  template <class RowOf>
  void column(Phase phase, const char* name, const VectorColumn& values, const RowOf& row_of) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      column(phase, name, std::span(values.axis(axis), values.size()), row_of);
  }
  const std::optional<Damage>& found() const { return found_; }

 private:
  Phase last_;
  std::optional<Damage> found_;
};

std::size_t same_row(std::size_t row) {
  return row;
}

/// What steps hand on to each other.
std::optional<Damage> search_state(const Simulation::State& state) {
  Search moving(Phase::motion), shapes(Phase::motion);
  moving.column(Phase::motion, "position", state.store.position, same_row);
  moving.column(Phase::motion, "velocity", state.store.velocity, same_row);
  if (moving.found()) return moving.found();
  for (const BodyState& body : state.bodies) {
    const ShapeMatching& shape = body.shape;
    const auto particle = [&](std::size_t i) { return body.begin + i; };
    const auto region = [&](std::size_t j) { return body.begin + shape.first_row(j); };
    shapes.column(Phase::reference_update, "reference position", shape.reference, particle);
    if (!shape.built) continue;
    shapes.column(Phase::reference_update, "weight", shape.weight, particle);
    shapes.column(Phase::reference_update, "weight of its region", shape.region_weight, region);
    shapes.column(Phase::reference_update, "centre of its region", shape.center, region);
    for (const Column<float>& moment : shape.moment)
      shapes.column(Phase::reference_update, "moment of its region", moment, region);
    for (const Column<float>& rotation : shape.rotation)
      shapes.column(Phase::rotations, "rotation of its region", rotation, region);
    for (const Column<float>& stretch : shape.plastic.stretch)
      shapes.column(Phase::rotations, "plastic stretch of its region", stretch, region);
  }
  return shapes.found();
}

void search_sph(const Simulation::State& state, Search& search) {
  const Sph& sph = state.sph;
  const auto sorted = [&](std::size_t place) { return sph.grid.order[place]; };
  search.column(Phase::neighbors, "sorted position", sph.grid.sorted, sorted);
  search.column(Phase::density, "density", sph.density, sorted);
  search.column(Phase::density, "pressure", sph.pressure, sorted);
  search.column(Phase::density, "volume", sph.volume, sorted);
  if (!state.sph_ran) return;
  if (sph.viscous) search.column(Phase::accelerations, "sorted velocity", sph.velocity, sorted);
  search.column(Phase::accelerations, "acceleration by SPH", sph.acceleration, same_row);
  if (state.walls())
    search.column(Phase::accelerations, "acceleration by walls", sph.walls.acceleration, same_row);
  if (state.cross_group())
    search.column(Phase::accelerations, "acceleration by other bodies", sph.cross_group, same_row);
}

void search_goals(const BodyState& body, Search& search) {
  const ShapeMatching& shape = body.shape;
  // The padding of a row is nobody's.
  for (std::size_t j = 0; j < shape.region_weight.size(); ++j)
    search.column(Phase::region_sums, "sum of its region", shape.sums.span().subspan(j * k_row, k_row_sums),
                  [&](std::size_t) { return body.begin + shape.first_row(j); });
  search.column(Phase::goals, "pull", shape.pull, [&](std::size_t i) { return body.begin + i; });
}

}  // namespace

std::optional<Damage> find_damage(const Simulation::State& state, Phase last) {
  if (const std::optional<Damage> found = search_state(state)) return found;
  Search search(last);
  if (state.density_ran) search_sph(state, search);
  if (state.force) search.column(Phase::time_step, k_by_force, state.user_acceleration, same_row);
  for (const BodyState& body : state.bodies)
    if (body.matches_shape()) search_goals(body, search);
  return search.found();
}

std::ostringstream describe_particle(const Simulation::State& state, std::uint32_t row) {
  std::ostringstream text;
  text << "step " << state.step << ": particle " << state.store.id[row] << " at ("
       << state.far(state.store.position.get(row)).transpose() << ") ";
  return text;
}

namespace {

[[noreturn]] void refuse(const Simulation::State& state, const Damage& damage) {
  std::ostringstream text = describe_particle(state, damage.row);
  text << "has a number that is not finite: " << damage.column << ", of phase " << name(damage.phase);
  if (std::string_view(damage.column) == k_by_force)
    text << "; look at what the callback adds there";
  else
    text << "; lower solver.time_step (now " << state.base_step() << ") or material.pressure_coefficient"
         << (state.force ? ", or look at what the force callback adds" : "");
  throw StepError(text.str(), state.store.id[damage.row], damage.phase);
}

}  // namespace

void refuse_damage(const Simulation::State& state, Phase phase, std::uint32_t row) {
  refuse(state, find_damage(state, phase).value_or(Damage{phase, "velocity", row}));
}

void check_damage(const Simulation::State& state) {
  if (const std::optional<Damage> damage = find_damage(state, Phase::reference_update))
    refuse(state, *damage);
}

}  // namespace mallow

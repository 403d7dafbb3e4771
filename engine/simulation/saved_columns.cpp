// The columns of a saved state: a row a particle or a region.
#include <Eigen/LU>
#include <algorithm>

#include "config/field_tables.h"
#include "simulation/phases.h"
#include "simulation/saved_chunks.h"

namespace mallow {
namespace {

/// Some of n rows, in any order.
void require_rows(const UnpackingArchive& archive, std::span<const std::uint32_t> values, std::size_t n) {
  std::vector<bool> seen(n, false);
  for (const std::uint32_t value : values) {
    if (value >= n || seen[value]) archive.fail(std::to_string(value) + " appears twice or is too large");
    seen[value] = true;
  }
}

/// A number in a range for each particle, or none.
void unpack_painted(const SavedState& saved, const char* name, std::size_t n, const Range& range,
                    Column<float>& column) {
  unpack(saved, name, [&](UnpackingArchive& archive) {
    unpack_column(archive, column);
    if (!column.empty() && column.size() != n) archive.fail("there must be one for each particle, or none");
    for (const float value : column)
      if (!range.holds(value) || !std::isfinite(value)) archive.fail("a number must be" + range_text(range));
  });
}

void unpack_particles(const SavedState& saved, Simulation::State& state) {
  ParticleStore& store = state.store;
  const std::size_t n = state.bodies.empty() ? 0 : state.bodies.back().end;
  unpack(saved, "ids", [&](UnpackingArchive& archive) {
    unpack_column(archive, store.id);
    if (store.size() != n) archive.fail("there must be one for each particle of the bodies");
  });
  unpack_slots(saved, "particle_slots", store.id.span(), store.slots);
  unpack(saved, "positions", [&](UnpackingArchive& archive) { archive.columns(store.position, n); });
  unpack(saved, "velocities", [&](UnpackingArchive& archive) { archive.columns(store.velocity, n); });
  unpack(saved, "pinned", [&](UnpackingArchive& archive) {
    unpack_column(archive, store.pin);
    if (!store.pin.empty() && store.pin.size() != n)
      archive.fail("there must be one for each particle, or none");
    for (const std::uint16_t pin : store.pin)
      if (pin > state.pins.size()) archive.fail("there is no pin " + std::to_string(pin - 1));
  });
  unpack_painted(saved, "alphas", n, range_of(&Material::alpha), store.alpha);
  unpack_painted(saved, "stiffnesses", n, k_stiffness_factor, store.stiffness);
  unpack_painted(saved, "plastic_yields", n, range_of(&Material::plastic_yield), store.plastic_yield);
  if (std::ranges::any_of(state.bodies, &BodyState::paints_yield) && store.plastic_yield.empty())
    throw ConfigError("saved state, chunk 'plastic_yields'", "there must be some");
  unpack_painted(saved, "temperatures", n, range_of(&Material::temperature), store.temperature);
  unpack_painted(saved, "temperature_rests", n, k_finite, store.temperature_rest);
  const bool heated = std::ranges::any_of(state.bodies, &BodyState::is_heated);
  if (store.temperature.size() != store.temperature_rest.size() || (heated && store.temperature.empty()))
    throw ConfigError("saved state, chunk 'temperatures'", "there must be as many as rests, and some");
  const bool painted = std::ranges::any_of(state.bodies, &BodyState::is_painted);
  if (store.alpha.size() != store.stiffness.size() || (painted && store.alpha.empty()))
    throw ConfigError("saved state, chunk 'alphas'", "there must be as many as stiffnesses, and some");
  store.next_position.resize(n);
  store.next_velocity.resize(n);
}

/// Reference shapes, regions built on them anew, and the rotations that those start from.
void unpack_shapes(const SavedState& saved, const std::vector<ShapeSizes>& sizes, Simulation::State& state) {
  unpack(saved, "references", [&](UnpackingArchive& archive) {
    for (std::size_t b = 0; b < sizes.size(); ++b)
      archive.columns(state.bodies[b].shape.reference, sizes[b].references);
  });
  unpack(saved, "rotations", [&](UnpackingArchive& archive) {
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      ShapeMatching& shape = state.bodies[b].shape;
      if (!shape.built) continue;
      build_regions(state.execution, state.region_scratch, shape);
      if (shape.region_weight.size() != sizes[b].regions)
        archive.fail("this build of mallow makes " + std::to_string(shape.region_weight.size()) +
                     " regions of body '" + state.bodies[b].name + "', not " +
                     std::to_string(sizes[b].regions));
      for (Column<float>& component : shape.rotation) archive.array(component.data(), component.size());
    }
  });
}

/// Calls pass(shape) with those that flow.
template <class State, class Pass>
void for_stretches(State& state, const Pass& pass) {
  for (auto& body : state.bodies)
    if (body.shape.built && body.shape.flows) pass(body.shape);
}

void unpack_stretches(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "stretches", [&](UnpackingArchive& archive) {
    for_stretches(state, [&](ShapeMatching& shape) {
      for (Column<float>& component : shape.plastic.stretch)
        archive.array(component.data(), component.size());
      archive.array(shape.plastic.flow.data(), shape.plastic.flow.size());
      for (std::size_t j = 0; j < shape.plastic.flow.size(); ++j) {
        const CarriedStretch one = carried_stretch(shape.plastic, j);
        if (!(one.stretch.allFinite() && one.stretch.determinant() > 0 && one.flow >= 0))
          archive.fail("region " + std::to_string(j) + " is mirrored, flat or not finite");
      }
    });
  });
}

}  // namespace

void pack_columns(const Simulation::State& s, SavedState& saved) {
  const CellGrid& grid = s.sph.grid;
  const auto add = [&](Chunk chunk) { saved.chunks.push_back(std::move(chunk)); };
  add(packed_column("ids", s.store.id));
  pack_slots("particle_slots", s.store.slots, saved);
  add(packed_columns("positions", s.store.position));
  add(packed_columns("velocities", s.store.velocity));
  add(packed_column("pinned", s.store.pin));
  add(packed_column("alphas", s.store.alpha));
  add(packed_column("stiffnesses", s.store.stiffness));
  add(packed_column("plastic_yields", s.store.plastic_yield));
  add(packed_column("temperatures", s.store.temperature));
  add(packed_column("temperature_rests", s.store.temperature_rest));
  add(packed("references", [&](PackingArchive& archive) {
    for (const BodyState& body : s.bodies) archive.columns(body.shape.reference);
  }));
  add(packed("rotations", [&](PackingArchive& archive) {
    for (const BodyState& body : s.bodies)
      for (const Column<float>& component : body.shape.rotation)
        if (body.shape.built) archive.array(component.data(), component.size());
  }));
  add(packed("stretches", [&](PackingArchive& archive) {
    for_stretches(s, [&](const ShapeMatching& shape) {
      for (const Column<float>& component : shape.plastic.stretch)
        archive.array(component.data(), component.size());
      archive.array(shape.plastic.flow.data(), shape.plastic.flow.size());
    });
  }));
  add(packed("cell_order",
             [&](PackingArchive& archive) { archive.array(grid.order.data(), grid.order.size()); }));
  add(packed("searched", [&](PackingArchive& archive) {
    if (s.prepared && s.sph.kept.any) archive.columns(s.sph.kept.searched);
  }));
}

void unpack_columns(const SavedState& saved, const std::vector<ShapeSizes>& sizes, Simulation::State& state) {
  unpack_particles(saved, state);
  hold_sleepers(state);
  unpack_shapes(saved, sizes, state);
  unpack_stretches(saved, state);
}

void unpack_neighbors(const SavedState& saved, Simulation::State& state) {
  Sph& sph = state.sph;
  const std::size_t n = state.store.size();
  unpack(saved, "cell_order", [&](UnpackingArchive& archive) {
    unpack_column(archive, sph.grid.order);
    require_rows(archive, sph.grid.order.span(), n);
  });
  unpack(saved, "searched", [&](UnpackingArchive& archive) {
    if (archive.remaining() == 0) return;
    if (!state.prepared || sph.neighbor_slack <= 0 || sph.grid.order.size() != n)
      archive.fail("must be empty, as this simulation keeps no neighbour lists");
    VectorColumn searched;
    archive.columns(searched, n);
    VectorColumn by_row(n);
    for (std::size_t s = 0; s < n; ++s) by_row.set(sph.grid.order[s], searched.get(s));
    find_neighbors(by_row, state.execution, sph);
  });
}

}  // namespace mallow

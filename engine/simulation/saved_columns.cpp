// The columns of a saved state: a row a particle or a region.
#include <Eigen/LU>
#include <algorithm>

#include "particles/particle_columns.h"
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

void unpack_values(UnpackingArchive& archive, std::size_t n, const SavedColumn&, VectorColumn& column) {
  archive.columns(column, n);
}
template <class T>
void unpack_values(UnpackingArchive& archive, std::size_t n, const SavedColumn& saved, Column<T>& column) {
  unpack_column(archive, column);
  if (column.size() != n && !(saved.may_be_absent && column.empty()))
    archive.fail(std::string("there must be one for each particle") +
                 (saved.may_be_absent ? ", or none" : ""));
  for (const T value : column)
    if (!saved.range.holds(value) || !std::isfinite(value))
      archive.fail("a number must be" + range_text(saved.range));
}

void unpack_particles(const SavedState& saved, Simulation::State& state) {
  ParticleStore& store = state.store;
  const std::size_t n = state.bodies.empty() ? 0 : state.bodies.back().end;
  for_each_column(store, [&](const SavedColumn& of, auto& column) {
    unpack(saved, of.chunk, [&](UnpackingArchive& archive) { unpack_values(archive, n, of, column); });
  });
  unpack_slots(saved, "particle_slots", store.id.span(), store.slots);
  for (const std::uint16_t pin : store.pin)
    if (pin > state.pins.size())
      throw ConfigError("saved state, chunk 'pinned'", "there is no pin " + std::to_string(pin - 1));
  const auto check = [&](const std::string& chunk, const auto& has, const Column<float>& column,
                         const Column<float>& other, const char* text) {
    if (column.size() != other.size() || (column.empty() && std::ranges::any_of(state.bodies, has)))
      throw ConfigError("saved state, chunk '" + chunk + "'", text);
  };
  check("plastic_yields", &BodyState::paints_yield, store.plastic_yield, store.plastic_yield,
        "there must be some");
  check("temperatures", &BodyState::is_heated, store.temperature, store.temperature_rest,
        "there must be as many as rests, and some");
  check("alphas", &BodyState::is_painted, store.alpha, store.stiffness,
        "there must be as many as stiffnesses, and some");
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
  for_each_column(s.store, [&](const SavedColumn& of, const auto& column) {
    add(packed_column(of.chunk, column));
    if constexpr (std::is_same_v<decltype(column), const Column<ParticleId>&>)
      pack_slots("particle_slots", s.store.slots, saved);
  });
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

#include "mallow/saved_state.h"

#include <algorithm>
#include <string_view>

#include "core/archive.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/validation.h"

namespace mallow {
namespace {

/// Counted up whenever the chunks or what they mean change.
constexpr std::uint32_t k_version = 2;
static_assert(sizeof(std::size_t) == sizeof(std::uint64_t), "sizes are saved as they are");

// One list of members a type, for both ways: see PackingArchive.

/// The values of a list; each takes at least `bytes_each`.
template <class Archive, class List, class Pass>
void pass_list(Archive& archive, List& values, std::size_t bytes_each, const Pass& pass) {
  if constexpr (Archive::k_packs)
    archive(static_cast<std::uint64_t>(values.size()));
  else
    values.resize(archive.count(bytes_each));
  for (auto& value : values) pass(value);
}

template <class Archive, class Config>
void pass_solver(Archive& archive, Config& config) {
  auto printed = config.formulation == Formulation::printed;
  archive(config.time_step);
  archive(config.time_step_factor);
  archive(config.support_radius);
  archive(config.gravity);
  archive(config.update_period);
  archive(config.update_interval);
  archive(printed);
  archive(config.acoustic_limit);
  archive(config.contact_offset);
  archive(config.rotation_iterations);
  archive(config.neighbor_slack);
  archive(config.memory_limit);
  if constexpr (!Archive::k_packs)
    config.formulation = printed ? Formulation::printed : Formulation::conservative;
}

template <class Archive, class State>
void pass_clock(Archive& archive, State& state) {
  archive(state.step);
  archive(state.time);
  archive(state.last_time_step);
  archive(state.prepared);
  archive(state.passed_periods);
  auto source = static_cast<std::uint8_t>(state.time_step_source);
  archive(source);
  archive(state.scale.spacing);
  archive(state.scale.gravity);
  archive(state.scale.speed);
  if constexpr (!Archive::k_packs) {
    if (source > static_cast<std::uint8_t>(TimeStepSource::speed))
      archive.fail("the time step has no such source");
    state.time_step_source = static_cast<TimeStepSource>(source);
  }
}

template <class Archive>
void pass_alpha(Archive& archive, const AlphaSchedule& alpha) {
  pass_list(archive, alpha.keys(), 2 * sizeof(float), [&](const AlphaKey& key) {
    archive(key.time);
    archive(key.alpha);
  });
}
void pass_alpha(UnpackingArchive& archive, AlphaSchedule& alpha) {
  std::vector<AlphaKey> keys;
  pass_list(archive, keys, 2 * sizeof(float), [&](AlphaKey& key) {
    archive(key.time);
    archive(key.alpha);
  });
  alpha = AlphaSchedule(std::move(keys));
}

template <class Archive, class Material>
void pass_material(Archive& archive, Material& material) {
  pass_alpha(archive, material.alpha);
  archive(material.update_threshold);
  archive(material.pressure_coefficient);
  archive(material.viscosity);
  archive(material.elastic_time_step);
  archive(material.particle_mass);
  archive(material.rest_density);
  archive(material.cohesion);
  archive(material.region_radius);
  archive(material.region_stride);
}

/// How much of the chunks with a row a particle or region is a group's.
struct ShapeSizes {
  std::uint64_t references = 0, regions = 0;
};

template <class Archive, class Group>
void pass_group(Archive& archive, Group& group, ShapeSizes& sizes) {
  auto& frame = group.shape.frame;
  archive(group.name);
  pass_material(archive, group.material);
  archive(group.begin);
  archive(group.end);
  archive(group.spacing);
  archive(group.mass);
  archive(group.rest_density);
  archive(group.alpha);
  archive(group.external_sum);
  archive(group.external_weight);
  archive(group.grew);
  archive(group.shape.built);
  archive(group.shape.spacing);
  archive(group.shape.total_moment);
  archive.array(frame.rotation.coeffs().data(), 4);
  archive.array(frame.translation.data(), 3);
  archive(sizes.references);
  archive(sizes.regions);
}

template <class Archive, class Shape>
void pass_primitive(Archive& archive, Shape& shape) {
  if constexpr (std::is_same_v<std::remove_const_t<Shape>, Plane>) {
    archive(shape.normal);
    archive(shape.offset);
  } else if constexpr (std::is_same_v<std::remove_const_t<Shape>, Sphere>) {
    archive(shape.center);
    archive(shape.radius);
    archive(shape.inside);
  } else {
    archive(shape.min);
    archive(shape.max);
    archive(shape.inside);
  }
}

/// Which alternative a variant of shapes holds; unpacking makes it hold that.
template <class Archive, class Shapes>
void pass_kind(Archive& archive, Shapes& shapes) {
  auto kind = static_cast<std::uint8_t>(shapes.index());
  archive(kind);
  if constexpr (!Archive::k_packs) {
    if (kind >= std::variant_size_v<Shapes>) archive.fail(std::to_string(kind) + " is not a kind of shape");
    if (kind == 0) shapes = Plane{};
    if (kind == 1) shapes = Sphere{};
    if (kind == 2) shapes = Box{};
    if constexpr (std::variant_size_v < Shapes >> 3)
      if (kind == 3) shapes = Union{};
  }
}

template <class Archive, class Collider>
void pass_collider(Archive& archive, Collider& collider) {
  pass_kind(archive, collider.shape);
  std::visit(
      [&](auto& shape) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, Union>) {
          pass_list(archive, shape.parts, 16, [&](auto& part) {
            pass_kind(archive, part);
            std::visit([&](auto& one) { pass_primitive(archive, one); }, part);
          });
        } else {
          pass_primitive(archive, shape);
        }
      },
      collider.shape);
  archive(collider.velocity);
  archive(collider.restitution);
  archive(collider.friction);
}

template <class Pack>
Chunk packed(const char* name, const Pack& pack) {
  PackingArchive archive;
  pack(archive);
  return {name, archive.take()};
}

template <class T>
Chunk packed_column(const char* name, const Column<T>& column) {
  return packed(name, [&](PackingArchive& archive) { archive.array(column.data(), column.size()); });
}

Chunk packed_columns(const char* name, const VectorColumn& columns) {
  return packed(name, [&](PackingArchive& archive) { archive.columns(columns); });
}

/// Calls `read` with the bytes of a chunk, which it has to use up.
template <class Read>
void unpack(const SavedState& saved, const char* name, const Read& read) {
  const std::string* bytes = saved.find(name);
  if (!bytes) throw ConfigError(std::string("saved state, chunk '") + name + "'", "is missing");
  UnpackingArchive archive(name, *bytes);
  read(archive);
  archive.finish();
}

/// All that is left of a chunk.
template <class T>
void unpack_column(UnpackingArchive& archive, Column<T>& column) {
  column.resize(archive.remaining() / sizeof(T));
  archive.array(column.data(), column.size());
}

void require_permutation(const UnpackingArchive& archive, std::span<const std::uint32_t> values) {
  std::vector<bool> seen(values.size(), false);
  for (const std::uint32_t value : values) {
    if (value >= values.size() || seen[value])
      archive.fail(std::to_string(value) + " appears twice or is too large");
    seen[value] = true;
  }
}

void require_valid(const UnpackingArchive& archive, const Simulation::State& state, const Group& group,
                   const ShapeSizes& sizes, std::size_t begin) {
  Checks checks;
  check(group.material, checks);
  check_stiffness(state.config, group.material, checks);
  checks.finish();
  const auto require = [&](bool ok, const char* what) {
    if (!ok) archive.fail("group '" + group.name + "': " + what);
  };
  require(group.begin == begin && group.end >= begin, "its rows must follow those of the group before it");
  require(group.size() > 0 || !state.prepared, "it has no particles");
  for (const float value : {group.spacing, group.mass, group.rest_density})
    require(std::isfinite(value) && (value > 0 || group.size() == 0),
            "spacing, particle mass and rest density must be finite and above 0");
  require(group.alpha >= 0 && group.alpha <= 1, "alpha must be in [0, 1]");
  require(std::isfinite(group.external_sum) && group.external_sum >= 0 &&
              std::isfinite(group.external_weight) && group.external_weight >= 0,
          "mean acceleration must be finite and 0 or above");
  require(group.shape.spacing >= 0 && std::isfinite(group.shape.spacing),
          "spacing of the regions must be finite and 0 or above");
  require(!(group.grew && state.prepared), "it has particles that were not prepared");
  require(group.grew || !group.keeps_reference() || sizes.references == group.size(),
          "its reference shape must have as many particles as the group");
  require(sizes.references <= group.size(), "its reference shape has more particles than the group");
  require(!group.shape.built || sizes.references > 0, "there are regions without a reference shape");
}

std::vector<ShapeSizes> unpack_groups(const SavedState& saved, Simulation::State& state) {
  std::vector<ShapeSizes> sizes;
  unpack(saved, "groups", [&](UnpackingArchive& archive) {
    std::size_t rows = 0;
    constexpr std::size_t k_least_bytes = 64;
    pass_list(archive, state.groups, k_least_bytes, [&](Group& group) {
      pass_group(archive, group, sizes.emplace_back());
      require_valid(archive, state, group, sizes.back(), rows);
      rows = group.end;
      group.shape.region_radius = group.material.region_radius.value_or(state.config.support_radius);
      group.shape.region_stride = group.material.region_stride;
    });
    if (state.groups.size() > k_max_groups) archive.fail("there are more than 256");
    if (state.groups.empty() && state.prepared) archive.fail("there are none");
  });
  return sizes;
}

void unpack_obstacles(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "origin", [&](UnpackingArchive& archive) {
    archive(state.origin);
    if (!state.origin.allFinite()) archive.fail("is not finite");
  });
  unpack(saved, "colliders", [&](UnpackingArchive& archive) {
    Checks checks;
    for (std::vector<Collider>* colliders : {&state.colliders, &state.near_colliders}) {
      pass_list(archive, *colliders, 16, [&](Collider& collider) {
        pass_collider(archive, collider);
        check(collider, checks);
      });
    }
    checks.finish();
    if (state.near_colliders.size() != (state.is_far() ? state.colliders.size() : 0))
      archive.fail("there must be one relative to the origin for each collider");
  });
  unpack(saved, "pins", [&](UnpackingArchive& archive) {
    pass_list(archive, state.pin_velocities, sizeof(Vec3), [&](Vec3& velocity) {
      archive(velocity);
      if (!velocity.allFinite()) archive.fail("a velocity is not finite");
    });
    if (state.pin_velocities.size() > k_max_pins) archive.fail("there are more than 65535");
  });
}

void unpack_particles(const SavedState& saved, Simulation::State& state) {
  ParticleStore& store = state.store;
  const std::size_t n = state.groups.empty() ? 0 : state.groups.back().end;
  unpack(saved, "ids", [&](UnpackingArchive& archive) {
    unpack_column(archive, store.id);
    if (store.size() != n) archive.fail("there must be one for each particle of the groups");
    require_permutation(archive, store.id.span());
  });
  unpack(saved, "positions", [&](UnpackingArchive& archive) { archive.columns(store.position, n); });
  unpack(saved, "velocities", [&](UnpackingArchive& archive) { archive.columns(store.velocity, n); });
  unpack(saved, "pinned", [&](UnpackingArchive& archive) {
    unpack_column(archive, store.pin);
    if (!store.pin.empty() && store.pin.size() != n)
      archive.fail("there must be one for each particle, or none");
    for (const std::uint16_t pin : store.pin)
      if (pin > state.pin_velocities.size()) archive.fail("there is no pin " + std::to_string(pin - 1));
  });
  store.row_of_id.resize(n);
  for (std::size_t row = 0; row < n; ++row) store.row_of_id[store.id[row]] = static_cast<std::uint32_t>(row);
  store.next_position.resize(n);
  store.next_velocity.resize(n);
}

/// Reference shapes, regions built on them anew, and the rotations that those start from.
void unpack_shapes(const SavedState& saved, const std::vector<ShapeSizes>& sizes, Simulation::State& state) {
  unpack(saved, "references", [&](UnpackingArchive& archive) {
    for (std::size_t g = 0; g < sizes.size(); ++g)
      archive.columns(state.groups[g].shape.reference, sizes[g].references);
  });
  unpack(saved, "rotations", [&](UnpackingArchive& archive) {
    for (std::size_t g = 0; g < sizes.size(); ++g) {
      ShapeMatching& shape = state.groups[g].shape;
      if (!shape.built) continue;
      build_regions(state.threads, state.level, state.region_scratch, shape);
      if (shape.region_weight.size() != sizes[g].regions)
        archive.fail("this build of mallow makes " + std::to_string(shape.region_weight.size()) +
                     " regions of group '" + state.groups[g].name + "', not " +
                     std::to_string(sizes[g].regions));
      for (Column<float>& component : shape.rotation) archive.array(component.data(), component.size());
    }
  });
}

/// The order of the last neighbour search, which fluids are sorted by, and lists that are kept.
void unpack_neighbors(const SavedState& saved, Simulation::State& state) {
  Sph& sph = state.sph;
  const std::size_t n = state.store.size();
  unpack(saved, "cell_order", [&](UnpackingArchive& archive) {
    unpack_column(archive, sph.grid.order);
    if (!sph.grid.order.empty() && sph.grid.order.size() != n)
      archive.fail("there must be one entry for each particle, or none");
    require_permutation(archive, sph.grid.order.span());
  });
  unpack(saved, "searched", [&](UnpackingArchive& archive) {
    if (archive.remaining() == 0) return;
    if (!state.prepared || sph.neighbor_slack <= 0 || sph.grid.order.empty())
      archive.fail("must be empty, as this simulation keeps no neighbour lists");
    VectorColumn searched;
    archive.columns(searched, n);
    VectorColumn by_row(n);
    for (std::size_t s = 0; s < n; ++s) by_row.set(sph.grid.order[s], searched.get(s));
    find_neighbors(by_row, state.threads, state.level, sph);
  });
}

}  // namespace

SavedState Simulation::save() const {
  const State& s = *state_;
  const CellGrid& grid = s.sph.grid;
  SavedState saved;
  const auto add = [&](Chunk chunk) { saved.chunks.push_back(std::move(chunk)); };
  add(packed("version", [&](PackingArchive& archive) { archive(k_version); }));
  add(packed("solver", [&](PackingArchive& archive) { pass_solver(archive, s.config); }));
  add(packed("clock", [&](PackingArchive& archive) { pass_clock(archive, s); }));
  add(packed("groups", [&](PackingArchive& archive) {
    pass_list(archive, s.groups, 0, [&](const Group& group) {
      ShapeSizes sizes{group.shape.reference.size(),
                       group.shape.built ? group.shape.region_weight.size() : 0};
      pass_group(archive, group, sizes);
    });
  }));
  add(packed("origin", [&](PackingArchive& archive) { archive(s.origin); }));
  add(packed("colliders", [&](PackingArchive& archive) {
    for (const std::vector<Collider>* colliders : {&s.colliders, &s.near_colliders})
      pass_list(archive, *colliders, 0, [&](const Collider& collider) { pass_collider(archive, collider); });
  }));
  add(packed("pins", [&](PackingArchive& archive) {
    pass_list(archive, s.pin_velocities, 0, [&](const Vec3& velocity) { archive(velocity); });
  }));
  add(packed_column("ids", s.store.id));
  add(packed_columns("positions", s.store.position));
  add(packed_columns("velocities", s.store.velocity));
  add(packed_column("pinned", s.store.pin));
  add(packed("references", [&](PackingArchive& archive) {
    for (const Group& group : s.groups) archive.columns(group.shape.reference);
  }));
  add(packed("rotations", [&](PackingArchive& archive) {
    for (const Group& group : s.groups)
      for (const Column<float>& component : group.shape.rotation)
        if (group.shape.built) archive.array(component.data(), component.size());
  }));
  add(packed("cell_order", [&](PackingArchive& archive) {
    // An order of fewer rows than there are is never used again.
    if (grid.order.size() == s.store.size()) archive.array(grid.order.data(), grid.order.size());
  }));
  add(packed("searched", [&](PackingArchive& archive) {
    if (s.prepared && s.sph.kept.any) archive.columns(s.sph.kept.searched);
  }));
  return saved;
}

Simulation Simulation::restore(const SavedState& saved, int threads, std::shared_ptr<Executor> executor) {
  std::uint32_t version = 0;
  unpack(saved, "version", [&](UnpackingArchive& archive) { archive(version); });
  if (version != k_version)
    throw ConfigError("saved state", "is of version " + std::to_string(version) +
                                         "; this build of mallow reads " + std::to_string(k_version));
  SolverConfig config;
  unpack(saved, "solver", [&](UnpackingArchive& archive) { pass_solver(archive, config); });
  config.threads = threads;
  config.executor = std::move(executor);
  Simulation simulation(config);
  State& state = *simulation.state_;
  unpack(saved, "clock", [&](UnpackingArchive& archive) {
    pass_clock(archive, state);
    if (state.step < 0 || !std::isfinite(state.time) || !std::isfinite(state.last_time_step) ||
        state.last_time_step < 0)
      archive.fail("step and time_step must be 0 or above, and time finite");
    const SceneScale& scale = state.scale;
    const bool settled = state.config.time_step && scale.spacing > 0;
    if (!(std::isfinite(scale.spacing) && scale.spacing >= 0 && std::isfinite(scale.speed) &&
          scale.speed >= 0 && scale.gravity.allFinite() && std::isfinite(state.passed_periods)) ||
        (!settled && (state.prepared || scale.spacing > 0)))
      archive.fail("what settings follow from is not known");
  });
  const std::vector<ShapeSizes> sizes = unpack_groups(saved, state);
  unpack_obstacles(saved, state);
  unpack_particles(saved, state);
  unpack_shapes(saved, sizes, state);
  if (state.scale.spacing > 0) resolve_settings(state);
  if (state.prepared) describe_groups(state);
  unpack_neighbors(saved, state);
  return simulation;
}

}  // namespace mallow

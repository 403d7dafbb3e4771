#pragma once

#include <span>
#include <string>
#include <vector>

#include "config/field_archive.h"
#include "mallow/saved_state.h"
#include "simulation/state.h"

// What a saved state consists of: lists (materials, bodies, colliders, pins, emitters, events) and columns (a
// row a particle or a region). Each has one list of members a type, for both ways: see PackingArchive, and
// config/field_tables.h for those of configs.

namespace mallow {

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

inline Chunk packed_column(const char* name, const VectorColumn& columns) {
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

/// How much of the chunks with a row a particle or region is a body's.
struct ShapeSizes {
  std::uint64_t references = 0, regions = 0;
};

/// Ids and generations that were given back.
void pack_slots(const char* name, const Slots& slots, SavedState& saved);
/// Who has which slot, from the ids that a list holds in order. Throws ConfigError, as the rest here does.
void unpack_slots(const SavedState& saved, const char* name, std::span<const std::uint64_t> ids,
                  Slots& slots);

/// Materials, bodies, colliders, pins, emitters, sinks, events.
void pack_lists(const Simulation::State& state, SavedState& saved);
/// Returns the sizes of each body.
std::vector<ShapeSizes> unpack_lists(const SavedState& saved, Simulation::State& state);

/// Particles, reference shapes, regions, the order of the last neighbour search.
void pack_columns(const Simulation::State& state, SavedState& saved);
/// All but what neighbours leave: the settings that those need follow from the rest.
void unpack_columns(const SavedState& saved, const std::vector<ShapeSizes>& sizes, Simulation::State& state);
/// The order of the last neighbour search, which fluids are sorted by, and lists that are kept.
void unpack_neighbors(const SavedState& saved, Simulation::State& state);

}  // namespace mallow

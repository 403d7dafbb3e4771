#pragma once

#include <string>
#include <vector>

namespace mallow {

/// A named piece of a saved state. What its bytes mean is the business of whoever wrote it.
struct Chunk {
  std::string name = {};
  std::string bytes = {};
};

/// What Simulation::save() hands out and Simulation::restore() takes: its chunks by name. An application may
/// add chunks of its own under names that begin with its own, "game.score"; restore() passes them over.
struct SavedState {
  std::vector<Chunk> chunks = {};

  /// The bytes of a chunk, or nullptr where there is none of that name.
  const std::string* find(const std::string& name) const {
    for (const Chunk& chunk : chunks)
      if (chunk.name == name) return &chunk.bytes;
    return nullptr;
  }
};

}  // namespace mallow

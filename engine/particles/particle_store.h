#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/threads.h"

namespace mallow {

/// Positions, velocities and names of all particles, a row each. Groups are ranges of rows. A sort moves
/// rows; ids stay.
struct ParticleStore {
  VectorColumn position;  ///< [m]
  VectorColumn velocity;  ///< [m/s]
  Column<std::uint32_t> id;
  Column<std::uint32_t> row_of_id;
  Column<std::uint16_t> pin;  ///< 0: free, else 1 + index of the pin; empty where nothing is pinned

  // Where a step writes before it is known to be good; scratch of sorts in between.
  VectorColumn next_position;
  VectorColumn next_velocity;

  std::size_t size() const { return id.size(); }
  std::size_t bytes() const;

  /// Puts particles behind row `at`, moving later rows up. They get the next ids.
  void insert(std::size_t at, std::span<const Vec3> positions, std::span<const Vec3> velocities);
  /// Row begin + k becomes what row begin + order[k] was.
  void permute(std::size_t begin, std::span<const std::uint32_t> order, const Threads& threads);
};

}  // namespace mallow

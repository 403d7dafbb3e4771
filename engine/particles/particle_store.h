#pragma once

#include <cstdint>
#include <span>

#include "core/column.h"
#include "core/slots.h"
#include "core/threads.h"

namespace mallow {

/// Positions, velocities and names of all particles, a row each. Bodies are ranges of rows. A sort moves
/// rows; ids stay. Its columns are listed in particles/particle_columns.h.
struct ParticleStore {
  VectorColumn position;  ///< [m]
  VectorColumn velocity;  ///< [m/s]
  Column<ParticleId> id;
  Column<std::uint16_t> pin;  ///< 0: free, else 1 + index of the pin; empty where nothing is pinned
  // What some body has by particle; empty where none has, else bodies without hold their material's.
  Column<float> alpha;      ///< α, in [0, 1]
  Column<float> stiffness;  ///< factor on the modulus, >= 0
  Column<float>
      plastic_yield;  ///< strain from which its region flows, >= 0; of no meaning where none is its own
  Column<float> temperature;       ///< T [K]; empty where nothing carries heat
  Column<float> temperature_rest;  ///< what that leaves out of a double [K]
  Slots slots;                     ///< id -> row

  // Where a step writes before it is known to be good; scratch of sorts in between.
  VectorColumn next_position;
  VectorColumn next_velocity;
  Column<std::uint64_t> words;  ///< scratch of sorts

  std::size_t size() const { return id.size(); }
  std::size_t bytes() const;

  /// Puts particles behind row `at`, moving later rows up.
  void insert(std::size_t at, std::span<const Vec3> positions, std::span<const Vec3> velocities);
  /// Takes out the particles of these rows, ascending; the rows of the others keep their order.
  void erase(std::span<const std::uint32_t> rows);
  /// Row begin + k becomes what row begin + order[k] was.
  void permute(std::size_t begin, std::span<const std::uint32_t> order, const Threads& threads);
};

}  // namespace mallow

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/column.h"
#include "mallow/ids.h"

namespace mallow {

/// Who is in which row. A slot is a particle's for its life and then somebody else's, in the next generation:
/// an id of somebody who is gone is told from that of who came after.
struct ParticleSlots {
  static constexpr std::uint32_t k_free = UINT32_MAX;

  Column<std::uint32_t> row;         ///< of each slot's particle; k_free where it has none
  Column<std::uint32_t> generation;  ///< of each slot; empty until a particle is removed
  std::vector<std::uint32_t> free;   ///< slots without a particle; the last one is given away next

  std::size_t size() const { return row.size(); }
  std::size_t bytes() const {
    return row.bytes() + generation.bytes() + free.capacity() * sizeof(std::uint32_t);
  }

  /// An id for a new particle, whose row is still to be told.
  ParticleId take();
  void give_back(ParticleId id);
  /// Rows from `begin` on hold these.
  void place(std::size_t begin, std::span<const ParticleId> ids);
  /// Where a particle is; nothing where it is gone or never was.
  std::optional<std::size_t> find(ParticleId id) const;
};

}  // namespace mallow

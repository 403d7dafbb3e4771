#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/column.h"
#include "mallow/ids.h"

namespace mallow {

/// Where in a list whoever an id names is: the row of a particle, the index of a body. A slot is one's for
/// its life and then somebody else's, in the next generation: an id of somebody who is gone is told from that
/// of who came after. Ids are those of mallow/ids.h, as numbers.
struct Slots {
  static constexpr std::uint32_t k_free = UINT32_MAX;

  Column<std::uint32_t> index;       ///< of whom each slot is; k_free where it is nobody's
  Column<std::uint32_t> generation;  ///< of each slot; empty until somebody is removed
  std::vector<std::uint32_t> free;   ///< slots that are nobody's; the last one is given away next
  std::uint64_t given_back = 0;      ///< the sum of all generations

  std::size_t size() const { return index.size(); }
  /// How many ids there have been.
  std::uint64_t given() const { return index.size() - free.size() + given_back; }
  std::size_t bytes() const {
    return index.bytes() + generation.bytes() + free.capacity() * sizeof(std::uint32_t);
  }

  /// An id for somebody new, whose index is still to be told.
  std::uint64_t take();
  void give_back(std::uint64_t id);
  /// These stand at `begin` and behind it.
  void place(std::size_t begin, std::span<const std::uint64_t> ids);
  /// Where somebody is; nothing where they are gone or never were.
  std::optional<std::size_t> find(std::uint64_t id) const;
};

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mallow/surface.h"

namespace mallow {

/// Vectors of the particles of one surface, seen where they lie: of all rows those that are listed.
struct PickedVectors {
  StridedVectors all;
  std::span<const std::uint32_t> rows;

  std::size_t size() const { return rows.size(); }
  Vec3 operator[](std::size_t number) const { return all[rows[number]]; }
};

}  // namespace mallow

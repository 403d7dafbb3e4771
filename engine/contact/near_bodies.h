#pragma once

#include <cstdint>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "core/range_blocks.h"

namespace mallow {

struct ShapeMatching;

/// A body as contact sees it.
struct TouchingBody {
  std::size_t begin, end;      ///< rows
  std::uint32_t group;         ///< bodies of one group are parts of one and do not touch
  float spacing;               ///< h [m]
  float mass;                  ///< of a particle, m [kg]
  float friction;              ///< Coulomb's μ_f
  const ShapeMatching* shape;  ///< null: nothing says which way is out of it
};

/// Particles that may be near one of another body: those in its bounding box, a reach wider. All others are
/// not looked at again.
struct NearBodies {
  Column<std::uint32_t> row;   ///< of each such particle, ascending
  Column<std::uint32_t> body;  ///< of each

  // Scratch.
  RangeBlocks blocks;
  std::vector<Aabb> block_box, body_box;
  std::vector<std::uint32_t> by_place;                   ///< bodies by the lowest place of their boxes
  std::vector<std::vector<std::uint32_t>> others;        ///< per body: whose boxes are near its own
  std::vector<std::vector<std::uint32_t>> block_others;  ///< per block likewise
  std::vector<std::uint32_t> count;                      ///< per block
  Column<std::uint32_t> found;                           ///< per block, from its first row on

  std::size_t bytes() const { return row.bytes() + body.bytes() + found.bytes(); }
};

/// reach: > 0 [m]. The same for any number of threads.
void find_near_bodies(const VectorColumn& positions, const std::vector<TouchingBody>& bodies, float reach,
                      const Execution& execution, NearBodies& near);

}  // namespace mallow

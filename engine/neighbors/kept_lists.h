#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/column.h"
#include "core/threads.h"
#include "neighbors/cell_grid.h"

namespace mallow {

/// Lets neighbour lists outlive small motions [Verlet 1967]. Lists that were searched within radius (1 +
/// slack) hold every pair within the radius until some point has moved by slack radius/2: two that come from
/// beyond the one to within the other have to. Motions count relative to the mean motion of all, which
/// changes no distance, so points that fall together keep their lists.
struct KeptLists {
  bool any = false;       ///< there are lists to keep
  VectorColumn searched;  ///< where the points were in the search, in the grid's order [m]

  // Scratch.
  std::vector<std::array<double, 3>> partial_motion;
  std::vector<double> partial_farthest;

  /// To be called when points get other numbers. Keeps the memory: rows are sorted now and then.
  void forget() { any = false; }
  std::size_t bytes() const { return searched.bytes(); }
};

/// Where the lists of the last search still hold, makes grid.sorted the present positions and returns true.
/// positions: finite, as many points as were searched. radius > 0, slack in [0, 1].
bool keep_lists(const VectorColumn& positions, float radius, float slack, const Threads& threads,
                CellGrid& grid, KeptLists& kept);
/// The lists have just been searched on this grid.
void remember_search(const CellGrid& grid, KeptLists& kept);

}  // namespace mallow

#pragma once

#include <vector>

#include "mallow/export.h"
#include "mallow/simulation.h"

namespace mallow {

/// Of each row, the place of the thread whose share it is in the loops over the bodies that move: what that
/// thread begins with in every step. It is a share and no record: one that is done takes blocks of others.
/// Below 0 where the body moves not, being asleep or disabled. Costs steps nothing: shares follow from the
/// bodies as they are.
MALLOW_EXPORT std::vector<int> thread_shares(const Simulation& simulation);

}  // namespace mallow

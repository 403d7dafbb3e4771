#pragma once

#include <filesystem>
#include <vector>

#include "stability/grid.h"

namespace mallow::bench {

/// Draws a panel for each alpha and time step, in it a field for each k and μ, coloured by how it ended at
/// the worst of the restitutions. Outcomes in the order of grid_point().
void write_map(const std::filesystem::path& svg, const StabilityGrid& grid,
               const std::vector<Outcome>& outcomes);

}  // namespace mallow::bench

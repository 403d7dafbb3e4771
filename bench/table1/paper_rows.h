#pragma once

#include <array>
#include <span>
#include <string>

namespace mallow::bench {

/// A row of Table 1 as [TK] prints it, and the scene that is it.
struct PaperRow {
  std::string name;    ///< of the scene in data/scenes/table1
  std::string figure;  ///< "Fig. 2 Bar"
  int particles;
  double neighbors;  ///< |Ñ|, the particle itself counted
  double alpha;
  double update_threshold;    ///< γ_u
  std::array<int, 3> voxels;  ///< V-size
  double fps1;                ///< without surface extraction and rendering
  double fps2;                ///< with both
};

/// All twelve, in the paper's order.
std::span<const PaperRow> paper_rows();

}  // namespace mallow::bench

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mallow/simulation.h"

namespace mallow::bench {

/// σ of the scaling runs in spacings: reaches 33 points of a full lattice (1 + 6 + 12 + 8 + 6), the last at 2
/// and the next at √5, so that small displacements do not change the count at once.
inline constexpr float k_cube_radius = 2.1f;

/// One body of the scaling runs, or several that are alike.
struct Cube {
  std::string material;        ///< one of cube_materials()
  std::array<int, 3> count{};  ///< lattice points a side of a body
  std::size_t bodies = 1;
  /// Bodies: or "touching", or "merging", as parts of one do; or "heap", thrown into a bin and still falling
  /// together, or "asleep", the same once all sleep.
  std::string between = "apart";
  bool in_a_bin() const { return between == "heap" || between == "asleep"; }
  std::size_t particles() const;
};

/// Names of what a cube can be made of: "elastic" has no SPH, "fluid" no shape matching, "gel" (alpha 0.3)
/// and "paste" both.
std::span<const std::string> cube_materials();
/// alpha of a material of that name.
float cube_alpha(const std::string& material);

/// min, 2 min, 4 min, ... up to max particles.
std::vector<std::size_t> cube_sizes(std::size_t min, std::size_t max);
/// The box nearest to a cube with `particles` points to within a percent or two, so that sizes double and two
/// threads have twice the work of one; or so many bodies that have their share each, one at least.
Cube make_cube(const std::string& material, std::size_t particles, std::size_t bodies = 1,
               const std::string& between = "apart");
/// Mean number of points of its body within the support radius of one, the point itself included.
double average_neighbors(const Cube& cube);

/// The cube on a floor, at rest density, stirred by waves of velocity that are the same whatever the size:
/// the regions of a body at rest would need no Newton iterations.
Simulation build(const Cube& cube, int threads, std::shared_ptr<Executor> executor = nullptr);
/// Runs what lies in a bin until it is what `between` says; nothing of others.
void settle(const Cube& cube, Simulation& simulation);

}  // namespace mallow::bench

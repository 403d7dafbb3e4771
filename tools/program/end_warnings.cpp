#include "program/end_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

namespace mallow::program {
namespace {

/// Spacings within which nothing at rest has a neighbour.
constexpr float k_crushed = 0.3f;
/// Share of crushed particles from which on a body shows it. A paste of 2560 particles with plastic_yield
/// 0.02 on a plate that turns at 2, 6 and 12 rad/s ended with shares of 0, 0.016 and 0.095, with a
/// plastic_creep of 20 1/s with 0, 0 and 0.005. Densities do not tell: the largest compression was 0.13.
constexpr double k_most_crushed = 0.01;

/// Mean compression that no blow gives. Blocks of dough, clay and toothpaste under a lid that came down to
/// 0.55 of their height had 0.01 to 0.03 where they could go aside, 0.16 to 0.17 in a mould.
constexpr double k_most_compressed = 0.1;

/// All strain beyond the yield is gone within a step.
bool flows_at_once(const Material& material) {
  return (material.plastic_yield || material.plastic_yield_by_temperature) && !material.plastic_creep;
}

/// Above this alpha particles come near each other in splashes, which is no damage.
constexpr float k_mostly_elastic = 0.5f;

/// Elastic, and yields to what presses it though nobody asked for that.
bool yields_by_default(const Material& material, const BodyInfo& body) {
  const bool flows = material.plastic_yield || material.plastic_yield_by_temperature;
  return !flows && !material.update_threshold && body.shape_matching && body.alpha <= k_mostly_elastic;
}

/// Bodies of one material that were crushed, and the one that was most.
struct Crushed {
  std::size_t bodies = 0;
  double share = 0;
  std::string name;
};

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Vec3& x, double side) {
  Cell cell;
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::floor(static_cast<double>(x[axis]) / side));
  return cell;
}

}  // namespace

double crushed_share(std::span<const Vec3> positions, float spacing) {
  if (positions.empty()) return 0;
  const float reach = k_crushed * spacing;
  std::vector<std::pair<Cell, std::size_t>> cells;
  for (std::size_t i = 0; i < positions.size(); ++i)
    cells.emplace_back(cell_of(positions[i], static_cast<double>(reach)), i);
  std::ranges::sort(cells);
  const auto is_crushed = [&](const auto& own) {
    const auto [cell, i] = own;
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y) {
        const Cell begin{cell[0] + x, cell[1] + y, cell[2] - 1}, end{cell[0] + x, cell[1] + y, cell[2] + 2};
        auto other = std::ranges::lower_bound(cells, begin, {}, &std::pair<Cell, std::size_t>::first);
        for (; other != cells.end() && other->first < end; ++other)
          if (other->second != i && (positions[other->second] - positions[i]).squaredNorm() < reach * reach)
            return true;
      }
    return false;
  };
  return static_cast<double>(std::ranges::count_if(cells, is_crushed)) /
         static_cast<double>(positions.size());
}

std::vector<std::string> end_warnings(const Scene& scene, const SimulationInfo& info,
                                      const ParticleFrame& last) {
  const std::vector<std::size_t> materials = body_materials(scene);
  const std::size_t bodies = std::min(materials.size(), info.bodies.size());
  std::vector<std::vector<Vec3>> positions(bodies);
  for (std::size_t i = 0; i < last.positions.size(); ++i)
    if (last.bodies[i] < bodies) positions[last.bodies[i]].push_back(last.positions[i]);
  std::vector<Crushed> crushed(scene.materials.size());
  for (std::size_t body = 0; body < bodies; ++body) {
    const Material& material = scene.materials[materials[body]].material;
    if (!flows_at_once(material) && !yields_by_default(material, info.bodies[body])) continue;
    const double share = crushed_share(positions[body], info.bodies[body].spacing);
    if (share < k_most_crushed) continue;
    Crushed& all = crushed[materials[body]];
    ++all.bodies;
    if (share <= all.share) continue;
    all.share = share;
    all.name = info.bodies[body].name;
  }
  std::vector<std::string> all;
  for (std::size_t m = 0; m < crushed.size(); ++m) {
    if (crushed[m].bodies == 0) continue;
    std::array<char, 32> percent{};
    std::snprintf(percent.data(), percent.size(), "%.1f%%", 100 * crushed[m].share);
    all.push_back(
        "body '" + crushed[m].name + "': " + percent.data() +
        " of its particles ended nearer than 0.3 spacings to another" +
        (crushed[m].bodies > 1
             ? ", and so did some of " + std::to_string(crushed[m].bodies - 1) + " more of its material"
             : "") +
        (flows_at_once(scene.materials[m].material)
             ? ": it was crushed, as all strain beyond plastic_yield flows at once; give "
               "material.plastic_creep, 20 1/s for a paste"
             : ": it was crushed, as what pressed it was more than material.update_threshold bears, and "
               "does not come back; raise that for what shall stay elastic, or give youngs_modulus or "
               "solver.volume_iterations for more resistance"));
  }
  return all;
}

std::optional<std::string> pressed_warning(const RunReport::Compression& compression) {
  if (compression.mean < k_most_compressed) return std::nullopt;
  std::array<char, 32> percent{};
  std::snprintf(percent.data(), percent.size(), "%.0f%%", 100 * compression.mean);
  return std::string("matter was pressed together by ") + percent.data() +
         " in the mean where it was most: what closed on it left it less room than it fills, and its "
         "particles "
         "went into each other; let what closes stop earlier, or leave a gap of two spacings or more for it "
         "to go";
}

}  // namespace mallow::program

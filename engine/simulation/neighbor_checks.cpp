#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

const float k_usual_radius = default_support_radius(1);  // in spacings
/// Entries of neighbour lists that 32-bit places can name with a tenth to spare.
constexpr double k_most_pairs = std::numeric_limits<std::uint32_t>::max() / std::size_t{11} * 10;
constexpr double k_bytes_per_pair = sizeof(std::uint32_t);

/// Of one point from the nearest other one, at least as far as `enough` is a reason to go on looking.
float nearest_distance(const std::vector<Vec3>& points, std::size_t i, float enough) {
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t j = 0; j < points.size() && nearest > enough; ++j)
    if (j != i) nearest = std::min(nearest, (points[j] - points[i]).norm());
  return nearest;
}

/// Whether any two points are within the radius.
bool any_pair(const Simulation::State& state, const std::vector<Vec3>& points, float radius) {
  if (nearest_distance(points, 0, radius) <= radius) return true;
  VectorColumn column(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) column.set(i, points[i]);
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(column, 0, points.size(), radius, state.execution, grid);
  build_neighbor_lists(grid, radius, state.execution, lists);
  return lists.average() > 1;
}

void check_radius(const Simulation::State& state, const char* field, float radius, const Body& points) {
  const float spacing = points.spacing;
  if (radius >= spacing && any_pair(state, points.positions, radius)) return;
  // Points may be farther apart than their spacing says, and a jittered lattice is a little.
  const float nearest = nearest_distance(points.positions, 0, 0);
  const float apart = nearest > 1.5f * spacing ? nearest : spacing;
  std::ostringstream text;
  text << radius << " is not allowed for a body whose particles are " << apart
       << " m apart: none has a neighbour (4/3 pi (radius/spacing)^3 = " << full_neighbors(radius, apart)
       << "); " << k_usual_radius << " spacings, " << k_usual_radius * apart << " m, give "
       << std::round(full_neighbors(k_usual_radius, 1));
  throw ConfigError(field, text.str());
}

/// Where the radius of regions is set.
const char* region_field(const Material& material) {
  return material.region_radius ? "material.region_radius" : "solver.support_radius";
}

/// Where lists of pairs come from.
struct Pairs {
  const char* field;
  float radius;
  const BodyState* body;
  double each;   ///< neighbours of a particle, itself included, at most
  double count;  ///< pairs
};

std::vector<Pairs> pairs_of(const Simulation::State& state) {
  std::vector<Pairs> all;
  const auto add = [&](const char* field, float radius, const BodyState& body, std::size_t most) {
    const double each = std::min(static_cast<double>(most), 1 + full_neighbors(radius, body.spacing));
    all.push_back({field, radius, &body, each, each * static_cast<double>(body.size())});
  };
  for (const BodyState& body : state.bodies) {
    if (body.keeps_reference())
      add(region_field(body.material->settings), body.shape.region_radius, body, body.size());
    if (state.bodies.size() > 1 || body.paints_alpha || body.material->carries_heat() ||
        body.material->settings.alpha.highest() > 0)
      add("solver.support_radius", state.support_radius(), body, state.store.size());
  }
  return all;
}

}  // namespace

void check_neighbors(const Simulation::State& state, const Material& material, const Body& points) {
  if (points.positions.size() == 1) return;
  const auto flows = [](float alpha) { return alpha > 0; };
  const auto holds = [](float alpha) { return alpha < 1; };
  if (points.alpha.empty() ? material.alpha.highest() > 0 : std::ranges::any_of(points.alpha, flows))
    check_radius(state, "solver.support_radius", support_radius(state.config, points.spacing), points);
  if (points.alpha.empty() ? material.alpha.lowest() < 1 : std::ranges::any_of(points.alpha, holds))
    check_radius(state, region_field(material), region_radius(state.config, material, points.spacing),
                 points);
}

void check_memory(const Simulation::State& state) {
  const std::vector<Pairs> all = pairs_of(state);
  double bytes = 0;
  for (const Pairs& pairs : all) bytes += k_bytes_per_pair * pairs.count;
  const double allowed = static_cast<double>(state.config.memory_limit) * std::pow(2.0, 30);
  const auto most = std::max_element(all.begin(), all.end(),
                                     [](const Pairs& a, const Pairs& b) { return a.count < b.count; });
  if (most == all.end() || (bytes <= allowed && most->count <= k_most_pairs)) return;
  std::ostringstream text;
  const float spacing = most->body->spacing;
  text << most->radius << " is not allowed: with a spacing of " << spacing << " m in body '"
       << most->body->name << "' it holds " << full_neighbors(most->radius, spacing)
       << " neighbours (4/3 pi (radius/spacing)^3), here " << most->each << " of " << state.store.size()
       << " particles, and neighbour lists of " << bytes / std::pow(2.0, 30)
       << " GiB; at most solver.memory_limit = " << state.config.memory_limit << " GiB and " << k_most_pairs
       << " neighbours in all are allowed; " << k_usual_radius << " spacings, " << k_usual_radius * spacing
       << " m, give " << std::round(full_neighbors(k_usual_radius, 1)) << " each";
  throw ConfigError(most->field, text.str());
}

}  // namespace mallow

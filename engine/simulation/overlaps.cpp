#include "simulation/overlaps.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/precision.h"
#include "neighbors/neighbor_lists.h"

namespace mallow {
namespace {

/// Particles nearer than this share of the spacing are an error of the scene.
constexpr float k_overlap = 0.1f;

/// A point of the new body, or a particle that is there.
struct Particle {
  ParticleId id;
  const BodyState& body;
  float spacing;
};

[[noreturn]] void refuse(const Particle& a, const Particle& b, float distance, float limit,
                         const Vec3& place) {
  std::ostringstream text;
  if (&a.body == &b.body)
    text << "body '" << a.body.name << "' overlaps itself at (";
  else
    text << "bodies '" << a.body.name << "' and '" << b.body.name << "' overlap at (";
  text << text_of(place) << "): particles " << std::min(a.id, b.id) << " and " << std::max(a.id, b.id)
       << " are " << distance << " m apart, at least a tenth of the spacing (" << limit
       << " m) is needed; move a body, or leave out points that are given twice";
  throw ConfigError("body", text.str());
}

}  // namespace

void refuse_overlaps(Simulation::State& state, const BodyState& body, std::span<const Vec3> positions,
                     float spacing, const Vec3& origin) {
  const std::vector<std::uint32_t> rows =
      state.placed.near(state.store.position, state.step, spacing, positions, k_overlap * spacing);
  VectorColumn points(rows.size() + positions.size());
  for (std::size_t k = 0; k < rows.size(); ++k) points.set(k, state.store.position.get(rows[k]));
  for (std::size_t k = 0; k < positions.size(); ++k) points.set(rows.size() + k, positions[k]);
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(points, 0, points.size(), spacing, state.execution, grid);
  build_neighbor_lists(grid, k_overlap * spacing, state.execution, lists);

  const auto particle = [&](std::uint32_t k) -> Particle {
    if (k >= rows.size()) return {state.store.size() + k - rows.size(), body, spacing};
    const BodyState& other = state.body_of(rows[k]);
    return {state.store.id[rows[k]], other, other.spacing};
  };
  for (std::size_t s = 0; s < grid.order.size(); ++s) {
    const std::uint32_t i = grid.order[s];
    if (i < rows.size()) continue;
    for (const std::uint32_t t : lists.of(s)) {
      const std::uint32_t j = grid.order[t];
      if (j == i) continue;
      const Particle a = particle(i), b = particle(j);
      const float distance = (points.get(i) - points.get(j)).norm();
      const float limit = k_overlap * std::min(a.spacing, b.spacing);
      if (distance < limit)
        refuse(a, b, distance, limit, (origin.cast<double>() + points.get(i).cast<double>()).cast<float>());
    }
  }
}

}  // namespace mallow

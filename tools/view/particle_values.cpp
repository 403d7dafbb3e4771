#include "view/particle_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "simulation/thread_shares.h"

namespace mallow::view {
namespace {

constexpr float k_reach = 1.8f;  ///< of neighbours at rest [spacings]

using Cell = std::array<int, 3>;
struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    return static_cast<std::size_t>(cell[0]) * 73856093U ^ static_cast<std::size_t>(cell[1]) * 19349663U ^
           static_cast<std::size_t>(cell[2]) * 83492791U;
  }
};

/// Calls visit(i, j) for all pairs that are near, i in order.
template <class Visit>
void visit_pairs(const std::vector<Vec3>& points, float reach, const Visit& visit) {
  const auto cell_of = [&](const Vec3& x) -> Cell {
    return {static_cast<int>(std::floor(x.x() / reach)), static_cast<int>(std::floor(x.y() / reach)),
            static_cast<int>(std::floor(x.z() / reach))};
  };
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells;
  for (std::uint32_t i = 0; i < points.size(); ++i) cells[cell_of(points[i])].push_back(i);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Cell cell = cell_of(points[i]);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
      if (found == cells.end()) continue;
      for (const std::uint32_t j : found->second)
        if (j != i && (points[j] - points[i]).squaredNorm() < reach * reach) visit(i, j);
    }
  }
}

std::vector<Vec3> copied(const VectorView& view) {
  std::vector<Vec3> list(view.size());
  for (std::size_t k = 0; k < list.size(); ++k) list[k] = view[k];
  return list;
}

}  // namespace

void ParticleValues::find_strains(const Simulation& simulation, std::vector<float>& values) {
  values.assign(simulation.particle_count(), 0);
  const VectorView positions = simulation.positions();
  for (const BodyId body : simulation.bodies()) {
    RestNeighbors& near = neighbors_[body];
    try {
      std::vector<Vec3> rest = copied(simulation.rest_positions(body));
      if (rest != near.rest) {
        near = {std::move(rest), {0}, {}};
        visit_pairs(near.rest, k_reach * simulation.spacing(body), [&](std::uint32_t i, std::uint32_t j) {
          while (near.starts.size() <= i) near.starts.push_back(static_cast<std::uint32_t>(near.list.size()));
          near.list.push_back(j);
        });
        near.starts.resize(near.rest.size() + 1, static_cast<std::uint32_t>(near.list.size()));
      }
    } catch (const ConfigError&) {  // a fluid remembers no shape
      neighbors_.erase(body);
      continue;
    }
    const std::size_t first = simulation.rows(body).begin;
    for (std::size_t i = 0; i < near.rest.size(); ++i)
      for (std::uint32_t k = near.starts[i]; k < near.starts[i + 1]; ++k) {
        const std::size_t j = near.list[k];
        const float now = (positions[first + j] - positions[first + i]).norm();
        const float before = (near.rest[j] - near.rest[i]).norm();
        values[first + i] = std::max(values[first + i], std::abs(now / before - 1));
      }
  }
}

void ParticleValues::find(const Simulation& simulation, Shown shown, std::vector<float>& values) {
  values.clear();
  const auto copy = [&](std::span<const float> column) { values.assign(column.begin(), column.end()); };
  switch (shown) {
    case Shown::appearance:
      break;
    case Shown::density:
      copy(simulation.densities());
      break;
    case Shown::temperature:
      copy(simulation.temperatures());
      break;
    case Shown::strain:
      find_strains(simulation, values);
      break;
    case Shown::speed: {
      const VectorView velocities = simulation.velocities();
      for (std::size_t row = 0; row < velocities.size(); ++row) values.push_back(velocities[row].norm());
      break;
    }
    case Shown::alpha: {
      copy(simulation.alphas());
      if (!values.empty()) break;
      values.resize(simulation.particle_count());
      for (const BodyId body : simulation.bodies()) {
        const Material& material = simulation.material_settings(simulation.material(body));
        const Simulation::Rows rows = simulation.rows(body);
        std::fill(values.begin() + static_cast<std::ptrdiff_t>(rows.begin),
                  values.begin() + static_cast<std::ptrdiff_t>(rows.end),
                  material.alpha.at(simulation.time()));
      }
      break;
    }
    case Shown::body: {
      values.resize(simulation.particle_count());
      for (const BodyId body : simulation.bodies()) {
        const Simulation::Rows rows = simulation.rows(body);
        std::fill(values.begin() + static_cast<std::ptrdiff_t>(rows.begin),
                  values.begin() + static_cast<std::ptrdiff_t>(rows.end), static_cast<float>(slot_of(body)));
      }
      break;
    }
    case Shown::thread: {
      const std::vector<int> shares = thread_shares(simulation);
      values.assign(shares.begin(), shares.end());
      break;
    }
  }
}

}  // namespace mallow::view

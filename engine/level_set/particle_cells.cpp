#include "level_set/particle_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "mallow/instruction_level.h"

namespace mallow {
namespace {

/// Where a cell holds more particles than this (two are usual), of those in one place, an eighth of a spacing
/// wide, so many count.
constexpr std::uint32_t k_crowd = 64, k_crowd_keeps = 4;

const SearchKernels& search() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, search_kernels);
}

}  // namespace

void ParticleCells::sort(std::span<const Vec3> positions, float spacing, float radius,
                         const Threads& threads) {
  radius_ = radius;
  grid_.spacing = spacing;
  positions_.resize_unset(positions.size());
  parallel_for(threads, positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) positions_.set(i, positions[i]);
  });
  build_cell_grid(positions_, 0, positions.size(), radius, threads, best_instruction_level(), grid_);
  particle_.clear();
  if (!thin_crowds()) return;
  build_cell_grid(positions_, 0, positions_.size(), radius, threads, best_instruction_level(), grid_);
}

void ParticleCells::move(VectorColumn& positions, const Threads& threads) {
  std::vector<std::uint32_t> particles(count());
  for (std::size_t place = 0; place < count(); ++place) particles[place] = particle(place);
  particle_.swap(particles);
  positions_.swap(positions);
  build_cell_grid(positions_, 0, positions_.size(), radius_, threads, best_instruction_level(), grid_);
}

/// Leaves a few particles of those that share a place in crowded cells; tells whether there are any such.
bool ParticleCells::thin_crowds() {
  bool crowded = false;
  const std::size_t cells = grid_.cell_start.size() - 1;
  for (std::size_t c = 0; c < cells; ++c)
    crowded = crowded || grid_.cell_start[c + 1] - grid_.cell_start[c] > k_crowd;
  if (!crowded) return false;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places;  // place in a cell, particle in sorted order
  std::vector<std::uint32_t> kept;
  const float per_place = 8 / grid_.spacing;
  for (std::size_t c = 0; c < cells; ++c) {
    places.clear();
    for (std::uint32_t i = grid_.cell_start[c]; i < grid_.cell_start[c + 1]; ++i) {
      std::uint64_t place = 0;
      // Numbers that repeat after a million are as good: cells are not that large.
      for (const float x : grid_.sorted.get(i))
        place = place << 20 | (static_cast<std::uint64_t>(std::llround(std::floor(x * per_place))) & 0xFFFFF);
      places.emplace_back(place, i);
    }
    const bool crowd = places.size() > k_crowd;
    if (crowd) std::sort(places.begin(), places.end());
    for (std::size_t k = 0; k < places.size(); ++k)
      if (!crowd || k < k_crowd_keeps || places[k].first != places[k - k_crowd_keeps].first)
        kept.push_back(places[k].second);
  }
  VectorColumn positions;
  positions.resize(kept.size());
  particle_.resize(kept.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    positions.set(k, grid_.sorted.get(kept[k]));
    particle_[k] = grid_.order[kept[k]];
  }
  positions_.swap(positions);
  return true;
}

void ParticleCells::find_near(const Eigen::Vector3d& corner, double side, NearParticles& near) const {
  Bounds box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = static_cast<float>(corner[a]);
    box.high[a] = static_cast<float>(corner[a] + side);
  }
  find_near(box, corner, near);
}

void ParticleCells::find_near_cluster(std::size_t c, Eigen::Vector3d& corner, NearParticles& near) const {
  const Bounds box = search().box_of(search_input(grid_, radius_), c);
  for (int a = 0; a < 3; ++a) corner[a] = static_cast<double>(box.low[a]);
  find_near(box, corner, near);
}

void ParticleCells::find_near(const Bounds& box, const Eigen::Vector3d& corner, NearParticles& near) const {
  const SearchInput input = search_input(grid_, radius_);
  near.runs.resize(std::max(near.runs.size(), grid_.columns() + 1));
  const std::size_t runs = search().find_runs(input, box, near.runs.data());
  std::size_t most = 0;
  for (std::size_t r = 0; r < runs; ++r) most += near.runs[r].end - near.runs[r].begin;
  near.places.resize(std::max(near.places.size(), most + k_cluster));
  near.count = search().near_cluster(input, box, near.runs.data(), runs, near.places.data());
  for (std::vector<float>* axis : {&near.x, &near.y, &near.z})
    axis->resize(std::max(axis->size(), near.count));
  const double per_radius = 1 / static_cast<double>(radius_);
  const float* const from[3] = {grid_.sorted.x(), grid_.sorted.y(), grid_.sorted.z()};
  float* const to[3] = {near.x.data(), near.y.data(), near.z.data()};
  for (int a = 0; a < 3; ++a)
    for (std::size_t k = 0; k < near.count; ++k)
      to[a][k] = static_cast<float>((static_cast<double>(from[a][near.places[k]]) - corner[a]) * per_radius);
}

}  // namespace mallow

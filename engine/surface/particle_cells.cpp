#include "surface/particle_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "mallow/instruction_level.h"

namespace mallow {
namespace {

/// Where a cell holds more particles than this (two are usual), of those in one place, an eighth of a spacing
/// wide, so many count.
constexpr std::uint32_t k_crowd = 64, k_crowd_keeps = 4;

const SearchLanes& search() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, search_lanes);
}

Bounds box_at(const Eigen::Vector3d& corner, double side) {
  Bounds box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = static_cast<float>(corner[a]);
    box.high[a] = static_cast<float>(corner[a] + side);
  }
  return box;
}

}  // namespace

void ParticleCells::sort(const PickedVectors& positions, float spacing, float radius,
                         const Threads& threads) {
  radius_ = radius;
  grid_.spacing = spacing;
  positions_.resize_unset(positions.size());
  parallel_for(threads, positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) positions_.set(i, positions[i]);
  });
  particle_.clear();
  place_of_.resize(positions.size());
  sort_into_cells(threads);
  if (thin_crowds()) sort_into_cells(threads);
}

void ParticleCells::sort_into_cells(const Threads& threads) {
  build_cell_grid(positions_, 0, positions_.size(), radius_, {threads, best_instruction_level()}, grid_);
  parallel_for(threads, count(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t place = begin; place < end; ++place)
      place_of_[particle(place)] = static_cast<std::uint32_t>(place);
  });
}

void ParticleCells::move(VectorColumn& positions, const Threads& threads) {
  std::vector<std::uint32_t> particles(count());
  for (std::size_t place = 0; place < count(); ++place) particles[place] = particle(place);
  particle_.swap(particles);
  positions_.swap(positions);
  sort_into_cells(threads);
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

/// Puts what a search found in the order of numbers. Marks in two levels of bits take about a twentieth of
/// the time of a surface; std::sort took a third.
void ParticleCells::order_by_number(NearParticles& near) const {
  near.numbers.resize(std::max(near.numbers.size(), place_of_.size() / 64 + 1));
  near.words.resize(std::max(near.words.size(), near.numbers.size() / 64 + 1));
  const auto bit = [](std::size_t k) { return std::uint64_t{1} << (k % 64); };
  for (std::size_t k = 0; k < near.count; ++k) {
    const std::size_t number = particle(near.places[k]);
    near.numbers[number / 64] |= bit(number);
    near.words[number / 4096] |= bit(number / 64);
  }
  std::size_t to = 0;
  const auto take = [](std::uint64_t& bits) {
    const int lowest = std::countr_zero(bits);
    bits &= bits - 1;
    return static_cast<std::size_t>(lowest);
  };
  for (std::size_t w = 0; w <= place_of_.size() / 4096; ++w) {
    while (near.words[w] != 0) {
      const std::size_t word = 64 * w + take(near.words[w]);
      while (near.numbers[word] != 0) near.places[to++] = place_of_[64 * word + take(near.numbers[word])];
    }
  }
}

void ParticleCells::find_near(const Eigen::Vector3d& corner, double side, NearParticles& near) const {
  find_near(box_at(corner, side), corner, near);
}

void ParticleCells::find_places_near(const Eigen::Vector3d& corner, double side, NearParticles& near) const {
  find_places(box_at(corner, side), near);
}

void ParticleCells::positions(std::span<const std::uint32_t> places, std::vector<float>* axes) const {
  const float* const from[3] = {grid_.sorted.x(), grid_.sorted.y(), grid_.sorted.z()};
  for (int a = 0; a < 3; ++a) {
    axes[a].resize(std::max(axes[a].size(), places.size() + k_cluster));
    for (std::size_t k = 0; k < places.size(); ++k) axes[a][k] = from[a][places[k]];
  }
}

void ParticleCells::find_near_cluster(std::size_t c, Eigen::Vector3d& corner, NearParticles& near) const {
  const Bounds box = search().box_of(search_input(grid_, radius_), c);
  for (int a = 0; a < 3; ++a) corner[a] = static_cast<double>(box.low[a]);
  find_near(box, corner, near);
}

void ParticleCells::find_places(const Bounds& box, NearParticles& near) const {
  const SearchInput input = search_input(grid_, radius_);
  near.ranges.resize(std::max(near.ranges.size(), grid_.pillars() + 1));
  const std::size_t ranges = search().find_ranges(input, box, near.ranges.data());
  std::size_t most = 0;
  for (std::size_t r = 0; r < ranges; ++r) most += near.ranges[r].end - near.ranges[r].begin;
  near.places.resize(std::max(near.places.size(), most + k_cluster));
  near.count = search().near_cluster(input, box, near.ranges.data(), ranges, near.places.data());
  order_by_number(near);
}

void ParticleCells::find_near(const Bounds& box, const Eigen::Vector3d& corner, NearParticles& near) const {
  find_places(box, near);
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

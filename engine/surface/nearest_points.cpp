#include "surface/nearest_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "neighbors/cell_grid.h"
#include "neighbors/search_lanes.h"

namespace mallow {
namespace {

constexpr NearestPoint k_none = {std::numeric_limits<float>::infinity(), 0};

/// Searches within a radius: what is found there and no farther is the nearest.
class NearSearch {
 public:
  NearSearch(const VectorColumn& others, float spacing, float radius, const Threads& threads)
      : lanes_(lanes_of(best_instruction_level())), radius_(radius) {
    grid_.spacing = std::max(spacing, radius / 8);  // a wide search has no use for small cells
    build_cell_grid(others, 0, others.size(), radius, {threads, best_instruction_level()}, grid_);
    input_ = search_input(grid_, radius);
  }
  std::size_t pillars() const { return grid_.pillars(); }

  NearestPoint find(const Vec3& point, std::span<PlaceRange> room) const {
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) box.low[axis] = box.high[axis] = point[axis];
    const std::size_t count = lanes_.find_ranges(input_, box, room.data());
    NearestPoint nearest = k_none;
    float least = std::numeric_limits<float>::infinity();
    for (const PlaceRange& range : room.first(count))
      for (std::uint32_t place = range.begin; place < range.end; ++place) {
        const float squared = (grid_.sorted.get(place) - point).squaredNorm();
        const std::uint32_t index = grid_.order[place];
        if (squared > least || (squared == least && index >= nearest.index)) continue;
        least = squared;
        nearest.index = index;
      }
    nearest.distance = std::sqrt(least);
    return nearest.distance <= radius_ ? nearest : k_none;
  }

 private:
  static const SearchLanes& lanes_of(InstructionLevel level) { return MALLOW_SELECT(level, search_lanes); }

  const SearchLanes& lanes_;
  CellGrid grid_;
  SearchInput input_;
  float radius_;
};

}  // namespace

std::vector<NearestPoint> find_nearest(std::span<const Vec3> points, std::span<const Vec3> others,
                                       float spacing, const Threads& threads) {
  VectorColumn column(others.size());  // as the grid takes them
  for (std::size_t i = 0; i < others.size(); ++i) column.set(i, others[i]);
  std::vector<NearestPoint> nearest(points.size(), k_none);
  std::vector<std::uint32_t> left(points.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<std::uint32_t>(i);
  // Those that have nothing near are searched again, twice as far.
  for (float radius = spacing; !left.empty(); radius *= 2) {
    const NearSearch search(column, spacing, radius, threads);
    parallel_for(threads, left.size(), [&](std::size_t begin, std::size_t end) {
      std::vector<PlaceRange> room(search.pillars());
      for (std::size_t k = begin; k < end; ++k) nearest[left[k]] = search.find(points[left[k]], room);
    });
    std::erase_if(left, [&](std::uint32_t i) { return nearest[i].distance <= radius; });
  }
  return nearest;
}

}  // namespace mallow

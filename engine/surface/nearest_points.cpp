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

bool is_nearer(const NearestPoint& a, const NearestPoint& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
}

/// Puts one where it belongs among the sorted `nearest`; the last drops out.
void insert(const NearestPoint& one, std::span<NearestPoint> nearest) {
  if (!is_nearer(one, nearest.back())) return;
  std::size_t place = nearest.size() - 1;
  for (; place > 0 && is_nearer(one, nearest[place - 1]); --place) nearest[place] = nearest[place - 1];
  nearest[place] = one;
}

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

  /// Fills `nearest`, by distance and then index. What is left of it is at no distance.
  void find(const Vec3& point, std::span<PlaceRange> room, std::span<NearestPoint> nearest) const {
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) box.low[axis] = box.high[axis] = point[axis];
    const std::size_t count = lanes_.find_ranges(input_, box, room.data());
    std::ranges::fill(nearest, k_none);
    for (const PlaceRange& range : room.first(count))
      for (std::uint32_t place = range.begin; place < range.end; ++place)
        insert({(grid_.sorted.get(place) - point).squaredNorm(), grid_.order[place]}, nearest);
    for (NearestPoint& one : nearest) {
      one.distance = std::sqrt(one.distance);
      if (!(one.distance <= radius_)) one = k_none;
    }
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
  return find_several_nearest(points, others, 1, spacing, threads);
}

std::vector<NearestPoint> find_several_nearest(std::span<const Vec3> points, std::span<const Vec3> others,
                                               std::size_t count, float spacing, const Threads& threads) {
  VectorColumn column(others.size());  // as the grid takes them
  for (std::size_t i = 0; i < others.size(); ++i) column.set(i, others[i]);
  count = std::min(count, others.size());
  std::vector<NearestPoint> nearest(points.size() * count, k_none);
  const auto of = [&](std::uint32_t i) { return std::span(nearest).subspan(i * count, count); };
  std::vector<std::uint32_t> left(points.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<std::uint32_t>(i);
  // Those that have too few near are searched again, twice as far.
  for (float radius = spacing; !left.empty(); radius *= 2) {
    const NearSearch search(column, spacing, radius, threads);
    parallel_for(threads, left.size(), [&](std::size_t begin, std::size_t end) {
      std::vector<PlaceRange> room(search.pillars());
      for (std::size_t k = begin; k < end; ++k) search.find(points[left[k]], room, of(left[k]));
    });
    std::erase_if(left, [&](std::uint32_t i) { return of(i).back().distance <= radius; });
  }
  return nearest;
}

}  // namespace mallow

// The cells of points.
#include "neighbors/grid_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// The cell of `place` along an axis. Clamped before it is rounded down: a coordinate far outside would not
/// fit an integer. Rounded down before it is counted from the first cell: where that is then changes nothing.
MALLOW_INLINE Ints clamped_cell(const SearchInput& in, int axis, const Floats& place) {
  const Floats cell = (place - in.cells_from[axis]) * in.inverse_edge[axis];
  const int first = in.first[axis];
  const Floats within = larger(smaller(all(static_cast<float>(first + in.dims[axis] - 1)), cell),
                               all(static_cast<float>(first)));
  const Ints towards_zero = converted<Ints>(within);
  return towards_zero + is_larger(converted<Floats>(towards_zero), within) - first;
}

void cells_of(const SearchInput& in, ConstVectors points, std::size_t begin, std::size_t end,
              std::uint32_t* cells) noexcept {
  // As pillar_of, but for eight; only the last strip may be narrower.
  const int last_strip = (in.dims[1] - 1) / k_strip * k_strip, narrower = k_strip - (in.dims[1] - last_strip);
  const Floats last = all(static_cast<float>(last_strip));
  const auto cells_from = [&](std::size_t i) {
    const Ints x = clamped_cell(in, 0, load(points.x + i));
    const Ints y = clamped_cell(in, 1, load(points.y + i));
    const Ints z = clamped_cell(in, 2, load(points.z + i));
    const Ints width = k_strip - (~is_larger(last, converted<Floats>(y)) & narrower);
    const Ints pillar = (y & -k_strip) * in.dims[2] + z * width + (y & (k_strip - 1));
    return pillar * in.dims[0] + x;
  };
  std::size_t i = begin;
  for (; i + k_cluster <= end; i += k_cluster) store(cells_from(i), cells + i);
  if (i == end) return;
  std::uint32_t rest[k_cluster];
  store(cells_from(i), rest);
  for (std::size_t l = 0; i + l < end; ++l) cells[i + l] = rest[l];
}

}  // namespace

extern const GridLanes grid_lanes;
const GridLanes grid_lanes = {cells_of};

}  // namespace mallow::MALLOW_LEVEL

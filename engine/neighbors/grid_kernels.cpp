// The cells of points, and their sort.
#include "neighbors/grid_kernels.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// What `place` along an axis counts to, before it is rounded down. Clamped before: a coordinate far outside
/// would not fit an integer.
MALLOW_INLINE Floats clamped_cell(const SearchInput& in, int axis, const Floats& place) {
  const Floats cell = (place - in.origin[axis]) * in.inverse_edge[axis];
  return larger(smaller(all(static_cast<float>(in.dims[axis] - 1)), cell), Floats{});
}

void cells_of(const SearchInput& in, ConstVectors points, std::size_t begin, std::size_t end,
              std::uint32_t* cells) noexcept {
  // As column_of, but for eight; only the last strip may be narrower.
  const int last_strip = (in.dims[1] - 1) / k_strip * k_strip, narrower = k_strip - (in.dims[1] - last_strip);
  const Floats last = all(static_cast<float>(last_strip));
  const auto cells_from = [&](std::size_t i) {
    const Floats y_cell = clamped_cell(in, 1, load(points.y + i));
    const Ints x = __builtin_convertvector(clamped_cell(in, 0, load(points.x + i)), Ints);
    const Ints y = __builtin_convertvector(y_cell, Ints);
    const Ints z = __builtin_convertvector(clamped_cell(in, 2, load(points.z + i)), Ints);
    const Ints width = k_strip - (~is_larger(last, y_cell) & narrower);
    const Ints column = (y & -k_strip) * in.dims[2] + z * width + (y & (k_strip - 1));
    return column * in.dims[0] + x;
  };
  std::size_t i = begin;
  for (; i + k_cluster <= end; i += k_cluster) store(cells_from(i), cells + i);
  if (i == end) return;
  std::uint32_t rest[k_cluster];
  store(cells_from(i), rest);
  for (std::size_t l = 0; i + l < end; ++l) cells[i + l] = rest[l];
}

/// Lane l: the sum of the lanes up to it.
MALLOW_INLINE Ints running_sums(Ints v) {
  const Ints none = {};
  v += __builtin_shufflevector(none, v, 0, 8, 9, 10, 11, 12, 13, 14);
  v += __builtin_shufflevector(none, v, 0, 0, 8, 9, 10, 11, 12, 13);
  return v + __builtin_shufflevector(none, v, 0, 0, 0, 0, 8, 9, 10, 11);
}

std::uint32_t counts_to_places(std::uint32_t* counts, std::size_t chunks, std::size_t cells,
                               std::size_t first, std::size_t last, std::uint32_t place,
                               std::uint32_t* starts) noexcept {
  std::size_t cell = first;
  for (; cell + k_cluster <= last; cell += k_cluster) {
    Ints total = {};
    for (std::size_t c = 0; c < chunks; ++c) total += load(counts + c * cells + cell);
    const Ints behind = running_sums(total) + static_cast<int>(place);
    Ints next = behind - total;
    store(next, starts + cell);
    for (std::size_t c = 0; c < chunks; ++c) {
      const Ints here = load(counts + c * cells + cell);
      store(next, counts + c * cells + cell);
      next += here;
    }
    place = static_cast<std::uint32_t>(behind[k_cluster - 1]);
  }
  for (; cell < last; ++cell) {
    starts[cell] = place;
    for (std::size_t c = 0; c < chunks; ++c) {
      const std::uint32_t here = counts[c * cells + cell];
      counts[c * cells + cell] = place;
      place += here;
    }
  }
  return place;
}

}  // namespace

extern const GridKernels grid_kernels;
const GridKernels grid_kernels = {cells_of, counts_to_places};

}  // namespace mallow::MALLOW_LEVEL

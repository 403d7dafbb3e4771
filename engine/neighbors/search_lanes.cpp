// Neighbours of clusters (after Pall & Hess 2013) and of points.
#include "neighbors/search_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Share of the squared radius by which the box of a cluster may look farther away than its points do when
/// pairs are taken one by one.
constexpr float k_rounding = 1e-5f;

Bounds box_of(const SearchInput& in, std::size_t cluster) noexcept {
  const std::size_t first = in.cluster_start[cluster];
  const Ints in_cluster = k_count < static_cast<int>(in.cluster_start[cluster + 1] - first);
  const float* const axes[3] = {in.sorted.x, in.sorted.y, in.sorted.z};
  Bounds box;
  for (int a = 0; a < 3; ++a) {
    const Floats values = load(axes[a] + first);
    // Lanes behind a short cluster count as its first point.
    const Floats own = in_cluster ? values : all(values[0]);
    box.low[a] = smallest(own)[0];
    box.high[a] = -smallest(-own)[0];
  }
  return box;
}

/// Cell of a coordinate that is given from the origin on.
int cell_of(const SearchInput& in, int axis, float from_origin) {
  const float cell = from_origin * in.inverse_edge[axis], last = static_cast<float>(in.dims[axis] - 1);
  // What is not a number becomes 0.
  return static_cast<int>(cell > 0.0f ? (cell > last ? last : cell) : 0.0f);
}

/// Squared distance along an axis between a box and a cell. Cells at the border also hold what lies beyond.
float squared_distance(const SearchInput& in, int axis, const Bounds& from_origin, int cell) {
  const float low = static_cast<float>(cell) * in.edge[axis], high = low + in.edge[axis];
  const float below = cell > 0 ? low - from_origin.high[axis] : 0.0f;
  const float above = cell < in.dims[axis] - 1 ? from_origin.low[axis] - high : 0.0f;
  const float distance = below > above ? below : above;
  return distance > 0.0f ? distance * distance : 0.0f;
}

/// Cells along an axis that a box and what is within reach of it lie in.
struct CellRange {
  int first, last;
};
CellRange cells_within(const SearchInput& in, int axis, const Bounds& from_origin, float reach) {
  return {cell_of(in, axis, from_origin.low[axis] - reach),
          cell_of(in, axis, from_origin.high[axis] + reach)};
}

/// Eight pillars of a slice, next to each other in y: cells [first, last] of each may be in reach of a box.
struct PillarCells {
  int first[k_cluster], last[k_cluster];
  unsigned in_reach;  ///< bit k: of pillar k any are
};

/// squared_y: of the squared reach, what the distance to the slice leaves. No branch asks for a distance:
/// they could not be foreseen.
MALLOW_INLINE PillarCells pillars_within(const SearchInput& in, const Bounds& from_origin, int y,
                                         float squared_y) {
  const Floats zero = {}, place = converted<Floats>(k_count + y), low = place * in.edge[1];
  const Floats last_y = all(static_cast<float>(in.dims[1] - 1)),
               last_x = all(static_cast<float>(in.dims[0] - 1));
  const Floats below = where(is_larger(place, zero), low - from_origin.high[1]);
  const Floats above = where(is_larger(last_y, place), from_origin.low[1] - (low + in.edge[1]));
  const Floats distance = larger(larger(below, above), zero);
  const Floats squared_x = squared_y - distance * distance;
  const Floats chord = square_root(larger(squared_x, zero));
  const auto cells = [&](const Floats& x) {
    return converted<Ints>(larger(smaller(last_x, x * in.inverse_edge[0]), zero));
  };
  const Ints first = cells(from_origin.low[0] - chord), last = cells(from_origin.high[0] + chord);
  PillarCells pillars;
  copy_bytes(pillars.first, &first, sizeof first);
  copy_bytes(pillars.last, &last, sizeof last);
  pillars.in_reach = ~bits(is_larger(zero, squared_x));
  return pillars;
}

std::size_t find_ranges(const SearchInput& in, const Bounds& box, PlaceRange* ranges) noexcept {
  Bounds from_origin;
  for (int a = 0; a < 3; ++a) {
    from_origin.low[a] = box.low[a] - in.origin[a];
    from_origin.high[a] = box.high[a] - in.origin[a];
  }
  const float squared_reach = in.reach * in.reach;
  const auto nx = static_cast<std::size_t>(in.dims[0]);
  const CellRange slices = cells_within(in, 2, from_origin, in.reach);
  const CellRange rows = cells_within(in, 1, from_origin, in.reach);
  constexpr int k_pillars = static_cast<int>(k_cluster);
  std::size_t count = 0;
  for (int z = slices.first; z <= slices.last; ++z) {
    const float squared_y = squared_reach - squared_distance(in, 2, from_origin, z);
    for (int y = rows.first; y <= rows.last; y += k_pillars) {
      const PillarCells cells = pillars_within(in, from_origin, y, squared_y);
      const int n = rows.last - y < k_pillars ? rows.last - y + 1 : k_pillars;
      for (int k = 0; k < n; ++k) {
        const std::uint32_t* const pillar = in.cell_start + pillar_of(in.dims, y + k, z) * nx;
        // Always written, kept only if there are points.
        ranges[count] = {pillar[cells.first[k]], pillar[cells.last[k] + 1]};
        count += (cells.in_reach >> k & 1u) & (ranges[count].begin < ranges[count].end ? 1u : 0u);
      }
    }
  }
  return count;
}

std::size_t near_cluster(const SearchInput& in, const Bounds& box, const PlaceRange* ranges,
                         std::size_t count, std::uint32_t* out) noexcept {
  // Copies that what is written to `out` cannot alias.
  const float *const sx = in.sorted.x, *const sy = in.sorted.y, *const sz = in.sorted.z;
  const Floats low[3] = {all(box.low[0]), all(box.low[1]), all(box.low[2])};
  const Floats high[3] = {all(box.high[0]), all(box.high[1]), all(box.high[2])};
  const Floats limit = all(in.squared_radius * (1.0f + k_rounding));
  const Floats zero = {};
  const std::uint32_t* const start = out;
  for (std::size_t r = 0; r < count; ++r) {
    const std::uint32_t behind = ranges[r].end;
    for (std::uint32_t j = ranges[r].begin; j < behind; j += k_cluster) {
      const Floats x = load(sx + j), y = load(sy + j), z = load(sz + j);
      const Floats dx = larger(larger(low[0] - x, x - high[0]), zero);
      const Floats dy = larger(larger(low[1] - y, y - high[1]), zero);
      const Floats dz = larger(larger(low[2] - z, z - high[2]), zero);
      const unsigned near = bits_of(is_at_most(dx * dx + dy * dy + dz * dz, limit), behind - j);
      out += compress(near, k_count + static_cast<int>(j), out);
    }
  }
  return static_cast<std::size_t>(out - start);
}

std::size_t near_point(const SearchInput& in, std::size_t point, std::size_t n, const std::uint32_t* places,
                       ConstVectors from, std::uint32_t* out) noexcept {
  const Floats x = all(in.sorted.x[point]), y = all(in.sorted.y[point]), z = all(in.sorted.z[point]);
  const Floats limit = all(in.squared_radius);
  const std::uint32_t* const start = out;
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Floats dx = x - load(from.x + k), dy = y - load(from.y + k), dz = z - load(from.z + k);
    out += compress(bits_of(is_at_most(dx * dx + dy * dy + dz * dz, limit), n - k), load(places + k), out);
  }
  return static_cast<std::size_t>(out - start);
}

}  // namespace

extern const SearchLanes search_lanes;
const SearchLanes search_lanes = {box_of, find_ranges, near_cluster, near_point};

}  // namespace mallow::MALLOW_LEVEL

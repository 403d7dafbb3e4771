// Neighbours of clusters (after Pall & Hess 2013) and of points.
#include "neighbors/search_kernel.h"

#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Share of the squared radius by which the box of a cluster may look farther away than its points do when
/// pairs are taken one by one.
constexpr float k_rounding = 1e-5f;

struct Box {
  float low[3], high[3];
};

Box cluster_box(const SearchInput& in, std::size_t cluster) {
  const std::size_t begin = in.cluster_start[cluster], end = in.cluster_start[cluster + 1];
  const float* const axes[3] = {in.sorted.x, in.sorted.y, in.sorted.z};
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = box.high[a] = axes[a][begin];
    for (std::size_t i = begin + 1; i < end; ++i) {
      const float value = axes[a][i];
      box.low[a] = value < box.low[a] ? value : box.low[a];
      box.high[a] = value > box.high[a] ? value : box.high[a];
    }
  }
  return box;
}

/// Cell of a coordinate that is given from the origin on.
int cell_of(const SearchInput& in, int axis, float from_origin) {
  const float cell = from_origin / in.edge[axis], last = static_cast<float>(in.dims[axis] - 1);
  return static_cast<int>(cell < 0.0f ? 0.0f : cell > last ? last : cell);
}

/// Distance along an axis between a box and a cell. Cells at the border also hold what lies beyond.
float distance(const SearchInput& in, int axis, const Box& from_origin, int cell) {
  const float low = static_cast<float>(cell) * in.edge[axis], high = low + in.edge[axis];
  if (low > from_origin.high[axis] && cell > 0) return low - from_origin.high[axis];
  if (high < from_origin.low[axis] && cell < in.dims[axis] - 1) return from_origin.low[axis] - high;
  return 0;
}

std::size_t find_runs(const SearchInput& in, std::size_t cluster, Run* runs) noexcept {
  Box box = cluster_box(in, cluster);
  int first[3], last[3];
  for (int a = 0; a < 3; ++a) {
    box.low[a] -= in.origin[a];
    box.high[a] -= in.origin[a];
    first[a] = cell_of(in, a, box.low[a] - in.reach);
    last[a] = cell_of(in, a, box.high[a] + in.reach);
  }
  const float squared_reach = in.reach * in.reach;
  std::size_t count = 0;
  for (int z = first[2]; z <= last[2]; ++z) {
    const float dz = distance(in, 2, box, z);
    for (int y = first[1]; y <= last[1]; ++y) {
      const float dy = distance(in, 1, box, y);
      const float rest = squared_reach - (dy * dy + dz * dz);
      if (rest < 0) continue;
      const float reach = __builtin_sqrtf(rest);
      const std::size_t column =
          (static_cast<std::size_t>(z) * static_cast<std::size_t>(in.dims[1]) + static_cast<std::size_t>(y)) *
          static_cast<std::size_t>(in.dims[0]);
      const std::size_t x0 = column + static_cast<std::size_t>(cell_of(in, 0, box.low[0] - reach));
      const std::size_t x1 = column + static_cast<std::size_t>(cell_of(in, 0, box.high[0] + reach));
      runs[count] = {in.cell_start[x0], in.cell_start[x1 + 1]};
      count += runs[count].begin < runs[count].end;
    }
  }
  return count;
}

#ifdef __AVX2__
/// Per mask of eight lanes the lanes that are set, in order.
struct LaneTable {
  unsigned char lane[256][k_cluster];
};
constexpr LaneTable lane_table() {
  LaneTable table{};
  for (unsigned mask = 0; mask < 256; ++mask)
    for (unsigned l = 0, n = 0; l < k_cluster; ++l)
      if (mask >> l & 1) table.lane[mask][n++] = static_cast<unsigned char>(l);
  return table;
}
constexpr LaneTable k_lane_table = lane_table();
#endif

/// Writes the values of the lanes where the mask is, in order, and returns how many; may write k_cluster.
MALLOW_INLINE std::size_t compress(const Ints& mask, const Ints& values, std::uint32_t* out) {
#ifdef __AVX2__
  const int bits = _mm256_movemask_ps(reinterpret_cast<__m256>(mask));
  const __m256i lanes =
      _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(k_lane_table.lane[bits])));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), lanes));
  return static_cast<std::size_t>(__builtin_popcount(static_cast<unsigned>(bits)));
#else
  // Always written, kept only where the mask is: no branch to predict.
  std::size_t n = 0;
  for (std::size_t l = 0; l < k_cluster; ++l) {
    out[n] = static_cast<std::uint32_t>(values[l]);
    n -= static_cast<std::size_t>(mask[l]);
  }
  return n;
#endif
}

constexpr Ints k_count = {0, 1, 2, 3, 4, 5, 6, 7};

std::size_t near_cluster(const SearchInput& in, std::size_t cluster, const Run* runs, std::size_t count,
                         std::uint32_t* out) noexcept {
  const Box box = cluster_box(in, cluster);
  const float limit = in.squared_radius * (1.0f + k_rounding);
  const Floats zero = {};
  const std::uint32_t* const start = out;
  for (std::size_t r = 0; r < count; ++r) {
    for (std::uint32_t j = runs[r].begin; j < runs[r].end; j += k_cluster) {
      const Floats x = load(in.sorted.x + j), y = load(in.sorted.y + j), z = load(in.sorted.z + j);
      const Floats dx = larger(larger(box.low[0] - x, x - box.high[0]), zero);
      const Floats dy = larger(larger(box.low[1] - y, y - box.high[1]), zero);
      const Floats dz = larger(larger(box.low[2] - z, z - box.high[2]), zero);
      const Ints in_run = k_count < static_cast<int>(runs[r].end - j);
      const Ints near = (dx * dx + dy * dy + dz * dz <= limit) & in_run;
      out += compress(near, k_count + static_cast<int>(j), out);
    }
  }
  return static_cast<std::size_t>(out - start);
}

std::size_t near_point(const SearchInput& in, std::size_t point, std::size_t n, const std::uint32_t* places,
                       ConstVectors from, std::uint32_t* out) noexcept {
  const float x = in.sorted.x[point], y = in.sorted.y[point], z = in.sorted.z[point];
  const std::uint32_t* const start = out;
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Floats dx = x - load(from.x + k), dy = y - load(from.y + k), dz = z - load(from.z + k);
    const Ints listed = k_count < static_cast<int>(n - k);
    const Ints near = (dx * dx + dy * dy + dz * dz <= in.squared_radius) & listed;
    Ints values;
    __builtin_memcpy(&values, places + k, sizeof values);
    out += compress(near, values, out);
  }
  return static_cast<std::size_t>(out - start);
}

}  // namespace

extern const SearchKernels search_kernels;
const SearchKernels search_kernels = {find_runs, near_cluster, near_point};

}  // namespace mallow::MALLOW_LEVEL

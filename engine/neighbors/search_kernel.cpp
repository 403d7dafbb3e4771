#include "neighbors/search_kernel.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Runs of sorted points that can be neighbours of a cell's points: three cells in x of the nine rows around
/// it.
int candidate_runs(const SearchInput& in, const int* cell, std::uint32_t (*runs)[2]) {
  int n = 0;
  const int x0 = cell[0] > 0 ? cell[0] - 1 : 0;
  const int x1 = cell[0] + 1 < in.dims[0] ? cell[0] + 1 : in.dims[0] - 1;
  for (int z = cell[2] - 1; z <= cell[2] + 1; ++z) {
    if (z < 0 || z >= in.dims[2]) continue;
    for (int y = cell[1] - 1; y <= cell[1] + 1; ++y) {
      if (y < 0 || y >= in.dims[1]) continue;
      const std::size_t row =
          (static_cast<std::size_t>(z) * static_cast<std::size_t>(in.dims[1]) + static_cast<std::size_t>(y)) *
          static_cast<std::size_t>(in.dims[0]);
      runs[n][0] = in.cell_start[row + static_cast<std::size_t>(x0)];
      runs[n][1] = in.cell_start[row + static_cast<std::size_t>(x1) + 1];
      if (runs[n][0] < runs[n][1]) ++n;
    }
  }
  return n;
}

std::size_t candidates(const SearchInput& in, const int* cell) {
  std::uint32_t runs[9][2];
  const int n = candidate_runs(in, cell, runs);
  std::size_t sum = 0;
  for (int r = 0; r < n; ++r) sum += runs[r][1] - runs[r][0];
  return sum;
}

std::size_t search(const SearchInput& in, const int* cell, std::size_t begin, std::size_t end,
                   std::uint32_t* out, std::uint32_t* count) {
  std::uint32_t runs[9][2];
  const int n = candidate_runs(in, cell, runs);
  const std::uint32_t* const start = out;
  for (std::size_t i = begin; i < end; ++i) {
    const float xi = in.sorted.x[i], yi = in.sorted.y[i], zi = in.sorted.z[i];
    const std::uint32_t* const first = out;
    for (int r = 0; r < n; ++r) {
      for (std::uint32_t j = runs[r][0]; j < runs[r][1]; ++j) {
        const float dx = xi - in.sorted.x[j], dy = yi - in.sorted.y[j], dz = zi - in.sorted.z[j];
        // Always written, kept only if near: no branch to predict.
        *out = j;
        out += (dx * dx + dy * dy + dz * dz) <= in.squared_radius;
      }
    }
    count[i] = static_cast<std::uint32_t>(out - first);
  }
  return static_cast<std::size_t>(out - start);
}

}  // namespace

extern const SearchKernels search_kernels;
const SearchKernels search_kernels = {candidates, search};

}  // namespace mallow::MALLOW_LEVEL

// Compiled once per instruction level, as all lanes are (core/isa.h).
#include "row_additions.h"

#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

constexpr std::size_t k_floats = 16;

constexpr std::size_t k_parts = k_floats / k_width;

/// Rows that are added at once, each to its own sum: enough to hide the latency of additions (four cycles,
/// two a cycle), and sums that fit into sixteen registers with room for what is loaded.
constexpr std::size_t k_sums = k_parts == 1 ? 8 : 8 / k_parts;

void add(const float* rows, std::size_t count, float* sum) noexcept {
  Lanes sums[k_sums][k_parts] = {};
  std::size_t row = 0;
  for (; row + k_sums <= count; row += k_sums)
    for (std::size_t s = 0; s < k_sums; ++s)
      for (std::size_t p = 0; p < k_parts; ++p) sums[s][p] += load(rows + (row + s) * k_floats + p * k_width);
  for (; row < count; ++row)
    for (std::size_t p = 0; p < k_parts; ++p) sums[0][p] += load(rows + row * k_floats + p * k_width);
  for (std::size_t p = 0; p < k_parts; ++p) {
    for (std::size_t s = 1; s < k_sums; ++s) sums[0][p] += sums[s][p];
    store(sums[0][p], sum + p * k_width);
  }
}

}  // namespace

extern const RowAdditions row_additions;
const RowAdditions row_additions = {add};

}  // namespace mallow::MALLOW_LEVEL

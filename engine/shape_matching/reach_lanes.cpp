// Regions of model section 2: the points within a radius of a point, eight tested at a time.
#include "shape_matching/reach_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Appends runs, joined where one follows on another.
class RunWriter {
 public:
  explicit RunWriter(Run* runs) : begin_(runs), next_(runs) {}
  void add(std::uint32_t first, std::uint32_t count) {
    if (run_.first + run_.count == first) {
      run_.count += count;
    } else {
      flush();
      run_ = {first, count};
    }
  }
  std::size_t finish() {
    flush();
    return static_cast<std::size_t>(next_ - begin_);
  }

 private:
  void flush() {
    *next_ = run_;
    next_ += run_.count > 0;
  }

  Run *begin_, *next_;
  Run run_{0, 0};
};

std::size_t runs_in_reach(const ReachInput& in, std::size_t s, ReachPillar* pillars, std::size_t count,
                          Run* runs, std::uint32_t& members) noexcept {
  const float x = in.along[s];
  const Floats a = all(in.across[0][s]), b = all(in.across[1][s]), limit = all(in.squared_radius);
  RunWriter writer(runs);
  members = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const float reach = pillars[c].reach;
    const std::uint32_t end = pillars[c].end;
    std::uint32_t first = pillars[c].first;
    // Differences as the test takes them: rounded, they are in the order of the points.
    while (first < end && in.along[first] - x < -reach) ++first;
    pillars[c].first = first;
    for (; first < end && in.along[first] - x <= reach; first += k_cluster) {
      const Floats dx = load(in.along + first) - x;
      const Floats da = load(in.across[0] + first) - a, db = load(in.across[1] + first) - b;
      unsigned near = bits(~is_larger((dx * dx + da * da) + db * db, limit));
      if (end - first < k_cluster) near &= (1u << (end - first)) - 1;
      members += static_cast<std::uint32_t>(count_bits(near));
      while (near != 0) {
        const auto from = static_cast<std::uint32_t>(first_bit(near));
        const auto length = static_cast<std::uint32_t>(first_bit(~(near >> from)));
        writer.add(first + from, length);
        near &= ~0u << (from + length);
      }
    }
  }
  return writer.finish();
}

}  // namespace

extern const ReachLanes reach_lanes;
const ReachLanes reach_lanes = {runs_in_reach};

}  // namespace mallow::MALLOW_LEVEL

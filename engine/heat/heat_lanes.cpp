// Conduction of heat between particles: Cleary & Monaghan 1999, for volumes as they are at rest.
#include "heat/heat_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

void flows(const HeatInput& in, std::size_t begin, std::size_t end, float* flow,
           float* conductance) noexcept {
  const bool grouped = in.group != nullptr;
  const float inverse_square = in.inverse_radius * in.inverse_radius;
  for (std::size_t cluster = begin; cluster < end; ++cluster) {
    const std::size_t first = in.lists.first[cluster], last = in.lists.first[cluster + 1];
    const std::uint32_t* const list = in.lists.indices + in.lists.begin[cluster];
    const std::uint32_t n = in.lists.count[cluster];
    const ClusterVec3 x = load(in.position, first);
    const Floats own_temperature = load(in.temperature + first), own_openness = load(in.openness + first);
    const HeatGroup& one = in.groups[grouped ? in.group[first] : 0];
    Ints own = Ints{} + (grouped ? static_cast<int>(in.group[first]) : 0);
    Floats own_conductivity = all(one.conductivity), own_factor = all(one.factor), own_touch = all(one.touch);
    if (grouped) {
      for (std::size_t i = first; i < last; ++i) {
        const HeatGroup& group = in.groups[in.group[i]];
        own[i - first] = static_cast<int>(in.group[i]);
        own_conductivity[i - first] = group.conductivity;
        own_factor[i - first] = group.factor;
        own_touch[i - first] = group.touch;
      }
    }
    Floats sum = {}, conducts = {};
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t j = list[k];
      const int number = grouped ? static_cast<int>(in.group[j]) : 0;
      const HeatGroup& group = in.groups[number];
      const ClusterVec3 d = difference(in.position, j, x);
      const Floats r2 = dot_from_left(d, d);
      const Floats t = larger(1.0f - r2 * inverse_square, Floats{});
      const Floats both = larger(own_conductivity + group.conductivity, all(1e-30f));
      // The harmonic mean of the conductivities, and the means of the two others: symmetric to the bit.
      Floats g = (own_conductivity * group.conductivity / both) * (own_factor + group.factor) *
                 (0.5f * (own_openness + in.openness[j])) * (t * t);
      if (grouped) {
        const Floats touch = 0.5f * (own_touch + group.touch);
        g = where(is_equal(own, number) | is_at_most(r2, touch * touch), g);
      }
      sum += g * (in.temperature[j] - own_temperature);
      conducts += where(is_larger(r2, Floats{}), g);
    }
    for (std::size_t i = first; i < last; ++i) {
      flow[in.lists.row_of[i]] = sum[i - first];
      conductance[in.lists.row_of[i]] = conducts[i - first];
    }
  }
}

}  // namespace

extern const HeatLanes heat_lanes;
const HeatLanes heat_lanes = {flows};

}  // namespace mallow::MALLOW_LEVEL

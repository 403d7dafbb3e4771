// Which points of other bodies one may touch in this step.
#include "contact/meeting_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

constexpr Ints k_count = {0, 1, 2, 3, 4, 5, 6, 7};

/// Of the mask the bits of the first `count` lanes.
MALLOW_INLINE unsigned bits_of(const Ints& mask, std::size_t count) {
  return bits(mask) & ((1u << (count < k_cluster ? count : k_cluster)) - 1);
}

std::size_t in_box(const ConstVectors& of, std::size_t begin, std::size_t end, const float* low,
                   const float* high, std::uint32_t* out) noexcept {
  const std::uint32_t* const start = out;
  const float* const axes[3] = {of.x, of.y, of.z};
  for (std::size_t j = begin; j < end; j += k_cluster) {
    Ints inside = ~Ints{};
    for (int a = 0; a < 3; ++a) {
      const Floats x = load(axes[a] + j);
      inside &= is_at_most(all(low[a]), x) & is_at_most(x, all(high[a]));
    }
    out += compress(bits_of(inside, end - j), k_count + static_cast<int>(j), out);
  }
  return static_cast<std::size_t>(out - start);
}

std::size_t meeting(const MeetingPoints& of, std::size_t n, const float* at, float way, float across,
                    std::uint32_t* out) noexcept {
  const ClusterVec3 from{all(at[0]), all(at[1]), all(at[2])};
  const Floats square_across = all(across * across), own_way = all(way);
  const std::uint32_t* const start = out;
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const ClusterVec3 r = load(of.position, k) - from;
    const Floats along = load(of.along + k) + own_way;
    const Ints near = is_at_most(squared(r), square_across + along * along);
    out += compress(bits_of(near, n - k), load(of.name + k), out);
  }
  return static_cast<std::size_t>(out - start);
}

}  // namespace

extern const MeetingLanes meeting_lanes;
const MeetingLanes meeting_lanes = {in_box, meeting};

}  // namespace mallow::MALLOW_LEVEL

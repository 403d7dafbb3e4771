// Points of bodies that may touch, eight at a time: what contact has to know of each, and which are near each
// other. A few are eight points whose rows follow each other, and so lie side by side.
#include "contact/point_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// So much wider than they would be where nothing rounds are the tests by which points are left out.
constexpr float k_wider = 1.001f;

MALLOW_INLINE ClusterVec3 get(const Vectors& from, std::size_t k) {
  return {load(from.x + k), load(from.y + k), load(from.z + k)};
}
/// The same vector in all lanes.
MALLOW_INLINE ClusterVec3 get_one(const Vectors& from, std::size_t k) {
  return {all(from.x[k]), all(from.y[k]), all(from.z[k])};
}
MALLOW_INLINE ClusterVec3 get_one(const float* v) {
  return {all(v[0]), all(v[1]), all(v[2])};
}
MALLOW_INLINE void put(const ClusterVec3& v, const Vectors& to, std::size_t k) {
  store(v.x, to.x + k);
  store(v.y, to.y + k);
  store(v.z, to.z + k);
}

MALLOW_INLINE float largest(const Floats& v) {
  return -smallest(-v)[0];
}
MALLOW_INLINE float sum_of(const Floats& v) {
  const Floats fours = v + shuffled<4, 5, 6, 7, 0, 1, 2, 3>(v);
  const Floats twos = fours + shuffled<2, 3, 0, 1, 6, 7, 4, 5>(fours);
  return twos[0] + twos[1];
}

/// The mean of n velocities of which this is the sum; 0 where it is no number.
MALLOW_INLINE void set_mean(const ClusterVec3& sum, std::size_t n, float* mean) {
  const float share = 1 / static_cast<float>(n);
  mean[0] = share * sum_of(sum.x);
  mean[1] = share * sum_of(sum.y);
  mean[2] = share * sum_of(sum.z);
  const float zero = mean[0] * 0 + mean[1] * 0 + mean[2] * 0;
  if (!(zero == 0)) mean[0] = mean[1] = mean[2] = 0;
}

/// The lanes of the last n of a loop.
MALLOW_INLINE Ints first_lanes(std::size_t n) {
  return k_count < static_cast<int>(n < k_cluster ? n : k_cluster);
}

void motion(const ConstVectors& positions, const ConstVectors& velocities, std::size_t begin, std::size_t end,
            LaneMotion& out) noexcept {
  const float* const axes[3] = {positions.x, positions.y, positions.z};
  Floats low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = all(k_infinity);
    high[a] = all(-k_infinity);
  }
  ClusterVec3 sum = {};
  for (std::size_t i = begin; i < end; i += k_cluster) {
    const Ints mask = first_lanes(end - i);
    for (int a = 0; a < 3; ++a) {
      const Floats x = load(axes[a] + i);
      low[a] = smaller(mask ? x : low[a], low[a]);  // the second where the first is no number
      high[a] = larger(mask ? x : high[a], high[a]);
    }
    sum += where(mask, load(velocities, i));
  }
  set_mean(sum, end - begin, out.velocity);
  const ClusterVec3 mean = get_one(out.velocity);
  Floats square = {};
  for (std::size_t i = begin; i < end; i += k_cluster)
    square = larger(where(first_lanes(end - i), squared(load(velocities, i) - mean)), square);
  for (int a = 0; a < 3; ++a) {
    out.low[a] = smallest(low[a])[0];
    out.high[a] = largest(high[a]);
  }
  out.spread = root(largest(square));
}

/// Rows of four numbers each; spoils them.
MALLOW_INLINE void put_rows(const ClusterVec3& vector, const Floats& number, float* rows) {
  Floats numbers[4] = {vector.x, vector.y, vector.z, number};
  store_rows(numbers, rows);
}

MALLOW_INLINE ClusterVec3 cross(const ClusterVec3& a, const ClusterVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// N_i: from the middle of the region of a particle to it.
MALLOW_INLINE ClusterVec3 outward(const BlockColumns& of, std::size_t k) {
  if (!of.reference.x) return of.outward.x ? load(of.outward, k) : ClusterVec3{};
  const ClusterVec3 rest = load(of.reference, k) - load(of.center, k);
  const ClusterVec3 q = {load(of.rotation[0] + k), load(of.rotation[1] + k), load(of.rotation[2] + k)};
  const ClusterVec3 half = cross(q, rest), whole = half + half;
  return (rest + load(of.rotation[3] + k) * whole) + cross(q, whole);
}

void place(const BlockColumns& of, std::size_t n, std::size_t first, const PointColumns& points,
           const FewColumns& fews) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const std::size_t p = first + k;
    const Ints mask = first_lanes(n - k);
    const Floats nowhere = all(k_not_a_number);
    const ClusterVec3 x = select(mask, load(of.position, k), ClusterVec3{nowhere, nowhere, nowhere});
    put(x, points.position, p);
    put_rows(x, all(of.half_spacing), points.place + 4 * p);
    const ClusterVec3 out = outward(of, k);
    const Floats depth = square_root(squared(out));
    put_rows(where(is_larger(depth, Floats{}), out / depth), depth, points.outward + 4 * p);
    Floats inverse_mass = all(of.inverse_mass);
    if (of.pin) inverse_mass = where(is_equal(load(of.pin + k), 0), inverse_mass);
    put_rows({inverse_mass, all(of.friction), all(of.adhesion)}, Floats{}, points.matter + 4 * p);
    store(inverse_mass, points.inverse_mass + p);
    const std::size_t few = p / k_cluster;
    const Floats end = all(k_infinity);
    fews.low.x[few] = smallest(smaller(x.x, end))[0];
    fews.low.y[few] = smallest(smaller(x.y, end))[0];
    fews.low.z[few] = smallest(smaller(x.z, end))[0];
    fews.high.x[few] = largest(larger(x.x, -end));
    fews.high.y[few] = largest(larger(x.y, -end));
    fews.high.z[few] = largest(larger(x.z, -end));
  }
}

void set_velocities(const ConstVectors& of, std::size_t n, std::size_t first, float* rows,
                    const FewColumns& fews) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const std::size_t p = first + k, few = p / k_cluster;
    const Ints mask = first_lanes(n - k);
    const ClusterVec3 v = where(mask, load(of, k));
    put_rows(v, Floats{}, rows + 4 * p);
    float mean[3];
    set_mean(v, n - k < k_cluster ? n - k : k_cluster, mean);
    const Floats square = where(mask, squared(v - get_one(mean)));
    fews.velocity.x[few] = mean[0];
    fews.velocity.y[few] = mean[1];
    fews.velocity.z[few] = mean[2];
    fews.spread[few] = root(largest(larger(square, Floats{})));
  }
}

void get_velocities(const float* rows, std::size_t n, std::size_t first, const Vectors& to) noexcept {
  const float* const from = rows + 4 * first;
  std::size_t k = 0;
  for (; k + k_cluster <= n; k += k_cluster) {
    Floats numbers[4];
    for (std::size_t t = 0; t < 4; ++t) numbers[t] = load_halves(from + 4 * (k + t), from + 4 * (k + t + 4));
    transpose_halves(numbers);
    put({numbers[0], numbers[1], numbers[2]}, to, k);
  }
  for (; k < n; ++k) {
    to.x[k] = from[4 * k];
    to.y[k] = from[4 * k + 1];
    to.z[k] = from[4 * k + 2];
  }
}

/// The way from one box to another along an axis.
MALLOW_INLINE Floats gap(const Floats& low, const Floats& high, const Floats& other_low,
                         const Floats& other_high) {
  return larger(Floats{}, larger(other_low - high, low - other_high));  // of what is no number: none
}
/// The square of the way from lanes of boxes, or of points, to others.
MALLOW_INLINE Floats squared_gap(const ClusterVec3& low, const ClusterVec3& high,
                                 const ClusterVec3& other_low, const ClusterVec3& other_high) {
  return squared(ClusterVec3{gap(low.x, high.x, other_low.x, other_high.x),
                             gap(low.y, high.y, other_low.y, other_high.y),
                             gap(low.z, high.z, other_low.z, other_high.z)});
}
/// Calls body(k, bits) for the fews [begin, end), a cluster at a time: those that meet a box.
template <class Body>
MALLOW_INLINE void for_fews_in(const FewColumns& of, std::size_t begin, std::size_t end, const LaneBox& box,
                               const Body& body) {
  const ClusterVec3 low = get_one(box.low), high = get_one(box.high);
  for (std::size_t k = begin; k < end; k += k_cluster) {
    const ClusterVec3 few_low = get(of.low, k), few_high = get(of.high, k);
    const Ints meets = is_at_most(few_low.x, high.x) & is_at_most(low.x, few_high.x) &
                       is_at_most(few_low.y, high.y) & is_at_most(low.y, few_high.y) &
                       is_at_most(few_low.z, high.z) & is_at_most(low.z, few_high.z);
    body(k, bits_of(meets, end - k));
  }
}

std::uint32_t fews_in_box(const FewColumns& of, std::size_t begin, std::size_t end,
                          const LaneBox& box) noexcept {
  std::uint32_t found = 0;
  for_fews_in(of, begin, end, box, [&](std::size_t k, unsigned set) { found |= set << (k - begin); });
  return found;
}

std::size_t list_fews(const FewColumns& of, std::size_t begin, std::size_t end, const LaneBox& box,
                      std::uint32_t* few, const FewColumns& list) noexcept {
  const float* const from[10] = {of.low.x,  of.low.y,      of.low.z,      of.high.x,     of.high.y,
                                 of.high.z, of.velocity.x, of.velocity.y, of.velocity.z, of.spread};
  float* const to[10] = {list.low.x,  list.low.y,      list.low.z,      list.high.x,     list.high.y,
                         list.high.z, list.velocity.x, list.velocity.y, list.velocity.z, list.spread};
  std::size_t count = 0;
  for_fews_in(of, begin, end, box, [&](std::size_t k, unsigned set) {
    if (set == 0) return;
    for (int c = 0; c < 10; ++c) compress(set, load(from[c] + k), to[c] + count);
    count += compress(set, k_count + static_cast<int>(k), few + count);
  });
  return count;
}

std::size_t near_fews(const FewColumns& of, std::size_t begin, std::uint32_t bits, const FewReach& reach,
                      const FewColumns& list, const std::uint32_t* few, std::size_t n, std::uint32_t count,
                      std::uint32_t* near, float* squares, OwnFew* own) noexcept {
  const FewColumns others = list;
  const Floats across = all(reach.across * reach.across), most = all(reach.most * reach.most);
  OwnFew* end = own;
  for (; bits != 0; bits &= bits - 1) {
    const std::size_t one = begin + static_cast<unsigned>(first_bit(bits));
    const ClusterVec3 low = get_one(of.low, one), high = get_one(of.high, one),
                      velocity = get_one(of.velocity, one);
    const Floats spread = all(of.spread[one]);
    const std::uint32_t before = count;
    for (std::size_t k = 0; k < n; k += k_cluster) {
      const Floats closing =
          square_root(squared(velocity - get(others.velocity, k))) + (spread + load(others.spread + k));
      const Floats along = reach.along + reach.time_step * closing;
      const Floats square = smaller(k_wider * k_wider * (across + along * along), most);
      const Ints meets = is_at_most(squared_gap(low, high, get(others.low, k), get(others.high, k)), square);
      const unsigned found = bits_of(meets, n - k);
      compress(found, load(few + k), near + count);
      count += static_cast<std::uint32_t>(compress(found, square, squares + count));
    }
    if (count > before) *end++ = {static_cast<std::uint32_t>(one), count};
  }
  return static_cast<std::size_t>(end - own);
}

std::size_t near_points(const ConstVectors& from, const FewColumns& of, const OwnFew* own, std::size_t n,
                        const std::uint32_t* near, const float* squares, std::uint32_t* scratch,
                        std::uint32_t* own_points, std::uint32_t* other_points) noexcept {
  const ConstVectors positions = from;  // copies, which what is stored cannot alias
  const FewColumns fews = of;
  std::size_t count = 0;
  std::uint32_t f = 0;
  for (const OwnFew* one = own; one != own + n; ++one) {
    const std::size_t first = one->few * k_cluster, room = room_of(one->end - f);
    const ClusterVec3 points = load(positions, first);
    std::uint32_t* ends[k_cluster];
    for (std::size_t i = 0; i < k_cluster; ++i) ends[i] = scratch + i * room;
    unsigned meeting = 0;
    for (; f != one->end; ++f) {
      const std::size_t few = near[f];
      const Floats square = all(squares[f]);
      unsigned left = bits(
          is_at_most(squared_gap(points, points, get_one(fews.low, few), get_one(fews.high, few)), square));
      meeting |= left;
      const ClusterVec3 others = load(positions, few * k_cluster);
      const Ints names = k_count + static_cast<int>(few * k_cluster);
      for (; left != 0; left &= left - 1) {
        const auto i = static_cast<std::size_t>(first_bit(left));
        const ClusterVec3 r = difference(positions, first + i, others);
        ends[i] += compress(bits(is_at_most(squared(r), square)), names, ends[i]);
      }
    }
    for (; meeting != 0; meeting &= meeting - 1) {
      const auto i = static_cast<std::size_t>(first_bit(meeting));
      const std::uint32_t* const list = scratch + i * room;
      const auto found = static_cast<std::size_t>(ends[i] - list);
      for (std::size_t k = 0; k < found; k += k_cluster) {
        store(Ints{} + static_cast<int>(first + i), own_points + count + k);
        store(load(list + k), other_points + count + k);
      }
      count += found;
    }
  }
  return count;
}

}  // namespace

extern const PointLanes point_lanes;
const PointLanes point_lanes = {motion,      place,     set_velocities, get_velocities,
                                fews_in_box, list_fews, near_fews,      near_points};

}  // namespace mallow::MALLOW_LEVEL

// Contact between bodies, eight pairs at a time: which touch, what way they push, and by how much.
#include "contact/contact_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Share of an overlap that a step takes away, but for what is left in peace, in d0: all of it at once would
/// throw particles apart, and what rests would tremble [Baumgarte 1972]. Of 200 cubes in a heap the one that
/// moves most does so at a third of the speed, and head-on nothing comes nearer than without.
constexpr float k_correction = 0.3f, k_slop = 0.02f;
/// Gap up to which what sticks is held, in d0.
constexpr float k_sticking = 0.1f;

/// Four numbers of each of eight points: a vector, and one more.
struct Row {
  ClusterVec3 vector;
  Floats number;
};
MALLOW_INLINE Row load_row(const float* rows, const std::uint32_t* names) {
  Floats numbers[4];
  load_named(rows, 4, names, numbers);
  return {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

struct Matter {
  Floats inverse_mass, friction, adhesion;
};
MALLOW_INLINE Matter matter(const float* rows, const std::uint32_t* names) {
  const Row row = load_row(rows, names);
  return {row.vector.x, row.vector.y, row.vector.z};
}

/// Names behind the last of n become that one, so that lanes may load what they name.
MALLOW_INLINE void fill(std::uint32_t* names, std::size_t n) {
  for (std::size_t k = n; k % k_cluster != 0; ++k) names[k] = names[n - 1];
}

MALLOW_INLINE Floats clamped(const Floats& value, float low, float high) {
  return smaller(larger(value, all(low)), all(high));
}

/// How far a normal turns from the line between two points to the way out of a body. along: cosine between
/// the two.
MALLOW_INLINE Floats turn(const Floats& along, const Floats& depth, const Floats& spacing) {
  const Floats s = clamped((along - 0.6f) / 0.3f, 0, 1);
  return s * s * (3 - 2 * s) * clamped((depth / spacing - 0.1f) / 0.15f, 0, 1);
}

/// The way from the second body to the first, and the distance along it beyond that at which they touch;
/// meets where they meet this way. Swapped points have the opposite normal and the same gap, to the bit.
struct Meeting {
  ClusterVec3 normal;
  Floats gap;
  Ints meets;
};
/// r: from j to i. i, j: the ways out of their bodies, and the depths.
MALLOW_INLINE Meeting meeting_of(const Row& i, const Row& j, const ClusterVec3& r, const Floats& square,
                                 const Floats& spacing) {
  const Floats distance = square_root(square);
  const ClusterVec3 line = r / distance;
  const Floats turn_i = turn(-dot(i.vector, line), i.number, spacing),
               turn_j = turn(dot(j.vector, line), j.number, spacing), most = larger(turn_i, turn_j);
  const Ints turns = is_larger(most, Floats{});
  if (!any(turns)) return {line, distance - spacing, ~Ints{}};
  // The flatter side wins: its particles have more of their body on one side. Where there is no depth there
  // is no turn either.
  const Floats cube_i = i.number * i.number * i.number, cube_j = j.number * j.number * j.number;
  const Floats weight_i = turn_i * (is_larger(cube_j, Floats{}) ? cube_j : all(1)),
               weight_j = turn_j * (is_larger(cube_i, Floats{}) ? cube_i : all(1));
  const ClusterVec3 out = (weight_j * j.vector - weight_i * i.vector) / (weight_i + weight_j);
  const ClusterVec3 mixed = (1 - most) * line + most * out;
  const ClusterVec3 normal = mixed / square_root(squared(mixed));
  const Floats height = dot(r, normal), across = k_across * spacing;
  return {select(turns, normal, line), (turns ? height : distance) - spacing,
          ~turns | is_at_most(square - height * height, across * across)};
}

std::size_t add_pairs(const ContactRows& of, const PairStep& step, std::uint32_t* own, std::uint32_t* other,
                      std::size_t n, const PairColumns& to) noexcept {
  if (n == 0) return 0;
  const PairColumns pairs = to;
  std::size_t count = 0;
  fill(own, n);
  fill(other, n);
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Row at_i = load_row(of.place, own + k), at_j = load_row(of.place, other + k);
    const ClusterVec3 r = at_i.vector - at_j.vector;
    const Floats square = squared(r), spacing = at_i.number + at_j.number, across = k_across * spacing;
    const Floats closing =
        square_root(squared(load_row(of.velocity, own + k).vector - load_row(of.velocity, other + k).vector));
    const Floats most = step.time_step * closing + step.pushed, along = spacing + most;
    // In one point nothing says which way.
    Ints touch =
        is_at_most(square, across * across + along * along) & is_larger(square, 1e-12f * spacing * spacing);
    if (!any(touch)) continue;
    const Meeting meeting =
        meeting_of(load_row(of.outward, own + k), load_row(of.outward, other + k), r, square, spacing);
    const Matter i = matter(of.matter, own + k), j = matter(of.matter, other + k);
    touch &=
        meeting.meets & is_at_most(meeting.gap, most) & is_larger(i.inverse_mass + j.inverse_mass, Floats{});
    const Floats closes = -meeting.gap / step.time_step, slop = k_slop * spacing / step.time_step;
    const Floats target =
        is_larger(Floats{}, meeting.gap) ? clamped(k_correction * (closes - slop), 0, step.max_push) : closes;
    const Floats stress = where(is_larger(k_sticking * spacing, meeting.gap), i.adhesion * j.adhesion);
    const unsigned found = bits_of(touch, n - k);
    compress(found, load(own + k), pairs.own + count);
    compress(found, load(other + k), pairs.other + count);
    compress(found, meeting.normal.x, pairs.normal.x + count);
    compress(found, meeting.normal.y, pairs.normal.y + count);
    compress(found, meeting.normal.z, pairs.normal.z + count);
    compress(found, target, pairs.target + count);
    compress(found, stress * spacing * spacing * step.time_step, pairs.sticks + count);
    count += compress(found, i.friction * j.friction, pairs.friction + count);
  }
  return count;
}

MALLOW_INLINE ClusterVec3 vectors(const Vectors& from, std::size_t k) {
  return {load(from.x + k), load(from.y + k), load(from.z + k)};
}

float acting(const float* velocities, const PairColumns& of, std::size_t n, const RoundColumns& to) noexcept {
  if (n == 0) return 0;
  const PairColumns pairs = of;  // copies, which what is stored cannot alias
  const RoundColumns round = to;
  fill(pairs.own, n);
  fill(pairs.other, n);
  Floats most = {};
  std::uint64_t word = 0;
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const ClusterVec3 w =
        load_row(velocities, pairs.own + k).vector - load_row(velocities, pairs.other + k).vector;
    const Floats along = dot(w, vectors(pairs.normal, k)), target = load(pairs.target + k);
    const Ints act = (is_larger(target, along) | is_larger(load(pairs.sticks + k), Floats{})) &
                     (k_count < static_cast<int>(n - k));
    store(w.x, round.closing.x + k);
    store(w.y, round.closing.y + k);
    store(w.z, round.closing.z + k);
    word |= std::uint64_t{bits(act)} << (k % k_word);
    round.acts[k / k_word] = word;
    if (k % k_word == k_word - k_cluster) word = 0;
    const Floats miss = target - along;
    most = larger(where(act, larger(miss, -miss)), most);
  }
  float result = 0;
  for (std::size_t l = 0; l < k_cluster; ++l) result = most[l] > result ? most[l] : result;
  return result;
}

/// Calls body(k) for each pair that acts, in order.
template <class Body>
MALLOW_INLINE void for_acting(const PointPairs& pairs, const Body& body) {
  for (std::size_t k = pairs.begin / k_word * k_word; k < pairs.end; k += k_word) {
    std::uint64_t left = pairs.acts[k / k_word];
    if (k < pairs.begin) left &= ~std::uint64_t{0} << (pairs.begin - k);
    if (pairs.end - k < k_word) left &= (std::uint64_t{1} << (pairs.end - k)) - 1;
    for (; left != 0; left &= left - 1) body(k + static_cast<std::size_t>(first_bit(left)));
  }
}
/// Calls body(pairs, k, place of the point in the block) for each pair that acts of those in which points of
/// a block are the second.
template <class Body>
MALLOW_INLINE void for_acting_earlier(const TouchingPoints& of, const Body& body) {
  for (std::size_t e = 0; e < of.earlier_count; ++e) {
    const PointPairs& pairs = of.earlier[e];
    for_acting(pairs, [&](std::size_t k) {
      const std::uint32_t at = pairs.points[k] - of.begin;  // below begin it wraps around
      if (at < of.end - of.begin) body(pairs, k, at);
    });
  }
}

std::uint32_t share(const TouchingPoints& of, const float* inverse_mass, float* shares) noexcept {
  float* const counts = shares + of.begin;
  const std::size_t n = of.end - of.begin;
  clear_bytes(counts, n * sizeof(float));
  for_acting(of.own, [&](std::size_t k) { counts[of.own.points[k] - of.begin] += 1; });
  for_acting_earlier(of, [&](const PointPairs&, std::size_t, std::uint32_t at) { counts[at] += 1; });
  std::uint32_t acting = 0;
  for (std::size_t i = 0; i < n; i += k_cluster) {
    const Floats count = load(counts + i);
    acting |= std::uint32_t{any(is_larger(count, Floats{}))} << (i / k_cluster);
    store(count * load(inverse_mass + of.begin + i), counts + i);
  }
  return acting;
}

/// Of each of eight points that names say.
MALLOW_INLINE Floats named(const float* values, const std::uint32_t* names) {
  return Floats{values[names[0]], values[names[1]], values[names[2]], values[names[3]],
                values[names[4]], values[names[5]], values[names[6]], values[names[7]]};
}

void impulses(const PairColumns& pairs, std::size_t n, const float* shares,
              const RoundColumns& round) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    if ((round.acts[k / k_word] >> (k % k_word) & 0xff) == 0) continue;
    const ClusterVec3 w = vectors(round.closing, k), normal = vectors(pairs.normal, k);
    const Floats along = dot(w, normal), sticks = load(pairs.sticks + k);
    const Floats mass = 1 / (named(shares, pairs.own + k) + named(shares, pairs.other + k));
    const Floats push = larger(mass * (load(pairs.target + k) - along), -sticks);
    const ClusterVec3 slip = w - along * normal;
    const Floats speed = square_root(squared(slip));
    const Floats rub = smaller(load(pairs.friction + k) * (larger(push, Floats{}) + sticks), mass * speed);
    const Floats per_speed = where(is_larger(speed, Floats{}), rub / speed);
    const ClusterVec3 impulse = push * normal - per_speed * slip;
    Floats numbers[4] = {impulse.x, impulse.y, impulse.z, Floats{}};
    store_rows(numbers, round.impulses + 4 * k);
    if (any(is_larger(sticks, Floats{})))
      store(larger(sticks - larger(-push, Floats{}), Floats{}), pairs.sticks + k);
  }
}

void push(const TouchingPoints& of, std::uint32_t acting, const float* inverse_mass, const float* shares,
          float* velocities) noexcept {
  alignas(32) float sums[4 * k_most_points];
  for (std::uint32_t left = acting; left != 0; left &= left - 1)
    clear_bytes(sums + 4 * k_cluster * static_cast<unsigned>(first_bit(left)), 4 * k_cluster * sizeof(float));
  for_acting(of.own, [&](std::size_t k) {
    float* const sum = sums + 4 * (of.own.points[k] - of.begin);
    store_quad(load_quad(sum) + load_quad(of.own.impulses + 4 * k), sum);
  });
  for_acting_earlier(of, [&](const PointPairs& pairs, std::size_t k, std::uint32_t at) {
    float* const sum = sums + 4 * at;
    store_quad(load_quad(sum) - load_quad(pairs.impulses + 4 * k), sum);
  });
  for (std::uint32_t left = acting; left != 0; left &= left - 1) {
    const std::size_t few = k_cluster * static_cast<unsigned>(first_bit(left));
    for (unsigned set = bits(is_larger(load(shares + of.begin + few), Floats{})); set != 0; set &= set - 1) {
      const std::size_t at = few + static_cast<unsigned>(first_bit(set)), p = of.begin + at;
      float* const velocity = velocities + 4 * p;
      store_quad(load_quad(velocity) + inverse_mass[p] * load_quad(sums + 4 * at), velocity);
    }
  }
}

}  // namespace

extern const ContactLanes contact_lanes;
const ContactLanes contact_lanes = {add_pairs, acting, share, impulses, push};

}  // namespace mallow::MALLOW_LEVEL

// Contact between bodies, eight points or pairs at a time: which points one may touch, what way they push,
// and by how much.
#include "contact/contact_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// So much wider than they would be where nothing rounds are the tests by which points are left out.
constexpr float k_wider = 1.001f;
/// Share of an overlap that a step takes away, but for what is left in peace, in d0: all of it at once would
/// throw particles apart, and what rests would tremble [Baumgarte 1972]. Of 200 cubes in a heap the one that
/// moves most does so at a third of the speed, and head-on nothing comes nearer than without.
constexpr float k_correction = 0.3f, k_slop = 0.02f;
/// Gap up to which what sticks is held, in d0.
constexpr float k_sticking = 0.1f;

std::size_t in_boxes(const ConstVectors& of, std::size_t begin, std::size_t end, const LaneBox* boxes,
                     std::size_t box_count, std::uint32_t* out) noexcept {
  const std::uint32_t* const start = out;
  const float* const axes[3] = {of.x, of.y, of.z};
  for (std::size_t j = begin; j < end; j += k_cluster) {
    Ints in_any = {};
    for (std::size_t b = 0; b < box_count; ++b) {
      Ints inside = ~Ints{};
      for (int a = 0; a < 3; ++a) {
        const Floats x = load(axes[a] + j);
        inside &= is_at_most(all(boxes[b].low[a]), x) & is_at_most(x, all(boxes[b].high[a]));
      }
      in_any |= inside;
    }
    out += compress(bits_of(in_any, end - j), k_count + static_cast<int>(j), out);
  }
  return static_cast<std::size_t>(out - start);
}

std::size_t in_box(const ConstVectors& of, std::size_t begin, std::size_t end, const LaneBox& box,
                   const ConstVectors& low, const ConstVectors& high, std::uint32_t* out) noexcept {
  const std::uint32_t* const start = out;
  const float *const axes[3] = {of.x, of.y, of.z}, *const lows[3] = {low.x, low.y, low.z},
                     *const highs[3] = {high.x, high.y, high.z};
  Floats from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    from[a] = all(box.low[a]);
    to[a] = all(box.high[a]);
  }
  const std::size_t boxes = (end - begin + k_cluster - 1) / k_cluster;
  for (std::size_t b = 0; b < boxes; b += k_cluster) {
    Ints meets = ~Ints{};
    for (int a = 0; a < 3; ++a)
      meets &= is_at_most(load(lows[a] + b), to[a]) & is_at_most(from[a], load(highs[a] + b));
    for (unsigned left = bits_of(meets, boxes - b); left != 0; left &= left - 1) {
      const std::size_t j = begin + k_cluster * (b + static_cast<unsigned>(first_bit(left)));
      Ints inside = ~Ints{};
      for (int a = 0; a < 3; ++a) {
        const Floats x = load(axes[a] + j);
        inside &= is_at_most(from[a], x) & is_at_most(x, to[a]);
      }
      out += compress(bits_of(inside, end - j), k_count + static_cast<int>(j), out);
    }
  }
  return static_cast<std::size_t>(out - start);
}

/// Four numbers of each of eight points: a vector, and one more.
struct Row {
  ClusterVec3 vector;
  Floats number;
};
MALLOW_INLINE Row load_row(const float* from, std::size_t stride, const std::uint32_t* names) {
  Floats numbers[4];
  load_named(from, stride, names, numbers);
  return {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

/// The rows of points: see ContactPoint and ContactVelocity.
constexpr std::size_t k_point = 12, k_velocity = 4;
MALLOW_INLINE Row place(const ContactRows& of, const std::uint32_t* names) {
  return load_row(of.points, k_point, names);
}
MALLOW_INLINE Row outward(const ContactRows& of, const std::uint32_t* names) {
  return load_row(of.points + 4, k_point, names);
}
struct Matter {
  Floats inverse_mass, friction, adhesion;
};
MALLOW_INLINE Matter matter(const ContactRows& of, const std::uint32_t* names) {
  const Row row = load_row(of.points + 8, k_point, names);
  return {row.vector.x, row.vector.y, row.vector.z};
}
MALLOW_INLINE Row velocity(const float* velocities, const std::uint32_t* names) {
  return load_row(velocities, k_velocity, names);
}

/// Names behind the last of n become that one, so that lanes may load what they name.
MALLOW_INLINE void fill(std::uint32_t* names, std::size_t n) {
  for (std::size_t k = n; k % k_cluster != 0; ++k) names[k] = names[n - 1];
}

void gather(const ContactRows& of, const PairStep& step, const float* frame, std::size_t n,
            const MeetingPoints& points) noexcept {
  fill(points.name, n);
  const ClusterVec3 frame_velocity = {all(frame[0]), all(frame[1]), all(frame[2])};
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Row at = place(of, points.name + k), moves = velocity(of.velocities, points.name + k);
    store(at.vector.x, points.position.x + k);
    store(at.vector.y, points.position.y + k);
    store(at.vector.z, points.position.z + k);
    const Floats way = step.time_step * square_root(squared(moves.vector - frame_velocity));
    store(k_wider * (at.number + 0.5f * step.pushed + way), points.along + k);
    store(k_wider * k_across * at.number, points.across + k);
  }
}

std::size_t meeting(const MeetingPoints& own, std::size_t i, const MeetingPoints& of, std::size_t n,
                    std::uint32_t* out) noexcept {
  const ClusterVec3 from{all(own.position.x[i]), all(own.position.y[i]), all(own.position.z[i])};
  const Floats own_along = all(own.along[i]), own_across = all(own.across[i]);
  const ConstVectors positions{of.position.x, of.position.y, of.position.z};
  const std::uint32_t* const start = out;
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const ClusterVec3 r = load(positions, k) - from;
    const Floats along = load(of.along + k) + own_along, across = load(of.across + k) + own_across;
    const Ints near = is_at_most(squared(r), across * across + along * along);
    out += compress(bits_of(near, n - k), load(of.name + k), out);
  }
  return static_cast<std::size_t>(out - start);
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
                      std::size_t n, const PairColumns& pairs, std::size_t count) noexcept {
  if (n == 0) return count;
  fill(own, n);
  fill(other, n);
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Row at_i = place(of, own + k), at_j = place(of, other + k);
    const ClusterVec3 r = at_i.vector - at_j.vector;
    const Floats square = squared(r), spacing = at_i.number + at_j.number, across = k_across * spacing;
    const Floats closing = square_root(
        squared(velocity(of.velocities, own + k).vector - velocity(of.velocities, other + k).vector));
    const Floats most = step.time_step * closing + step.pushed, along = spacing + most;
    // In one point nothing says which way.
    Ints touch =
        is_at_most(square, across * across + along * along) & is_larger(square, 1e-12f * spacing * spacing);
    if (!any(touch)) continue;
    const Meeting meeting = meeting_of(outward(of, own + k), outward(of, other + k), r, square, spacing);
    const Matter i = matter(of, own + k), j = matter(of, other + k);
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

/// How two points move against each other.
struct Closing {
  ClusterVec3 velocity;  ///< v_i − v_j
  Floats along;          ///< its part along n
  Floats share;          ///< of their inverse masses, those of pairs that act at the same time
  ClusterVec3 normal;
  Floats target, sticks;
};
MALLOW_INLINE Closing closing_of(const float* velocities, const PairColumns& pairs, std::size_t k) {
  const Row i = velocity(velocities, pairs.own + k), j = velocity(velocities, pairs.other + k);
  const ClusterVec3 w = i.vector - j.vector;
  const ClusterVec3 n{load(pairs.normal.x + k), load(pairs.normal.y + k), load(pairs.normal.z + k)};
  return {w, dot(w, n), i.number + j.number, n, load(pairs.target + k), load(pairs.sticks + k)};
}

float acting(const float* velocities, const PairColumns& pairs, std::size_t n, float* acts) noexcept {
  if (n == 0) return 0;
  fill(pairs.own, n);
  fill(pairs.other, n);
  Floats most = {};
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Closing c = closing_of(velocities, pairs, k);
    const Ints act =
        (is_larger(c.target, c.along) | is_larger(c.sticks, Floats{})) & (k_count < static_cast<int>(n - k));
    store(where(act, all(1)), acts + k);
    const Floats miss = c.target - c.along;
    most = larger(where(act, larger(miss, -miss)), most);
  }
  float result = 0;
  for (std::size_t l = 0; l < k_cluster; ++l) result = most[l] > result ? most[l] : result;
  return result;
}

void impulses(const float* velocities, const PairColumns& pairs, std::size_t n, const float* acts,
              float* rows) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    if (!any(is_larger(load(acts + k), Floats{}))) {
      for (std::size_t t = 0; t < 4; ++t) store(Floats{}, rows + 4 * k + t * k_cluster);
      continue;
    }
    const Closing c = closing_of(velocities, pairs, k);
    const Floats mass = 1 / c.share;
    const Floats push = larger(mass * (c.target - c.along), -c.sticks);
    const ClusterVec3 slip = c.velocity - c.along * c.normal;
    const Floats speed = square_root(squared(slip));
    const Floats rub = smaller(load(pairs.friction + k) * (larger(push, Floats{}) + c.sticks), mass * speed);
    const Floats per_speed = where(is_larger(speed, Floats{}), rub / speed);
    const ClusterVec3 impulse =
        where(is_larger(load(acts + k), Floats{}), push * c.normal - per_speed * slip);
    Floats numbers[4] = {impulse.x, impulse.y, impulse.z, Floats{}};
    store_rows(numbers, rows + 4 * k);
    if (any(is_larger(c.sticks, Floats{})))
      store(larger(c.sticks - larger(-push, Floats{}), Floats{}), pairs.sticks + k);
  }
}

}  // namespace

extern const ContactLanes contact_lanes;
const ContactLanes contact_lanes = {in_boxes, in_box, gather, meeting, add_pairs, acting, impulses};

}  // namespace mallow::MALLOW_LEVEL

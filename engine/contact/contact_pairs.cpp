#include "contact/contact_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/meeting_lanes.h"
#include "core/bounds.h"
#include "core/parallel.h"
#include "shape_matching/run_tables.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

/// Share of an overlap that a step takes away, but for what is left in peace, in d0: all of it at once would
/// throw particles apart, and what rests would tremble [Baumgarte 1972]. Of 200 cubes in a heap the one that
/// moves most does so at a third of the speed, and head-on nothing comes nearer than without.
constexpr float k_correction = 0.3f, k_slop = 0.02f;
/// Gap up to which what sticks is held, in d0.
constexpr float k_sticking = 0.1f;
/// Pairs of a point that there is room for from the start: more than rest or flow asks for, so that a motion
/// that goes on takes no more memory.
constexpr std::size_t k_room = 8;

/// From the middle of the regions of a particle to it, in the reference shape.
Vec3 rest_outward(const ShapeMatching& shape, std::size_t i) {
  const Vec3 x = shape.reference.get(i);
  if (shape.region_stride == 1) return x - shape.center.get(i);
  Vec3 middle = Vec3::Zero();
  const std::vector<std::uint32_t> regions = decode(shape.by_particle(), i);
  for (const std::uint32_t region : regions) middle += shape.center.get(region);
  return x - middle / static_cast<float>(regions.size());
}

/// N_i: which way out of its body a particle lies, and how near the surface. 0 in a fluid, which has no
/// shape.
Vec3 outward(const TouchingBody& body, std::size_t row) {
  if (!body.shape) return Vec3::Zero();
  const std::size_t i = row - body.begin, region = body.shape->first_region(i);
  const auto& q = body.shape->rotation;
  return Eigen::Quaternionf(q[3][region], q[0][region], q[1][region], q[2][region]) *
         rest_outward(*body.shape, i);
}

/// What is known of the points.
void gather(const VectorColumn& positions, const VectorColumn& velocities, const std::uint16_t* pin,
            const std::vector<TouchingBody>& bodies, const Threads& threads, ContactPairs& pairs) {
  const NearBlocks& near = pairs.near;
  const std::size_t n = near.row.size();
  pairs.positions.resize_unset(n);
  pairs.points.resize(n);
  pairs.velocity.resize(n);
  pairs.next_velocity.resize(n);
  parallel_for(threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const TouchingBody& body = bodies[block.range];
    for (std::uint32_t p = near.first_point[number]; p < near.first_point[number + 1]; ++p) {
      const std::uint32_t row = near.row[p];
      const Vec3 x = positions.get(row), v = velocities.get(row), out = outward(body, row);
      const float depth = out.norm();
      pairs.positions.set(p, x);
      pairs.velocity[p] = {v, 0};
      pairs.points[p] = {.position = x,
                         .outward = depth > 0 ? Vec3(out / depth) : Vec3(0, 0, 0),
                         .depth = depth,
                         .inverse_mass = pin && pin[row] != 0 ? 0.0f : 1.0f / body.mass,
                         .friction = std::sqrt(body.friction),
                         .adhesion = std::sqrt(body.adhesion),
                         .half_spacing = 0.5f * body.spacing};
    }
  });
}

/// How far a normal turns from the line between two points to the way out of a body. along: cosine between
/// the two.
float turn(float along, float depth, float spacing) {
  const float s = std::clamp((along - 0.6f) / 0.3f, 0.0f, 1.0f);
  return s * s * (3 - 2 * s) * std::clamp((depth / spacing - 0.1f) / 0.15f, 0.0f, 1.0f);
}

/// The distance between two points along n beyond that at which they touch, or infinity where they do not
/// meet this way. r: from j to i, shorter than anything that would overflow. Swapped points have the opposite
/// normal and the same gap, to the bit.
float gap_between(const ContactPoint& i, const ContactPoint& j, const Vec3& r, float spacing, Vec3& normal) {
  constexpr float k_never = std::numeric_limits<float>::infinity();
  const float square = r.squaredNorm();
  if (!(square > 1e-12f * spacing * spacing)) return k_never;  // in one point nothing says which way
  const float distance = std::sqrt(square);
  const Vec3 along = r / distance;
  const float along_i = -i.outward.dot(along), along_j = j.outward.dot(along);
  normal = along;
  if (along_i <= 0.6f && along_j <= 0.6f) return distance - spacing;
  const float turn_i = turn(along_i, i.depth, spacing), turn_j = turn(along_j, j.depth, spacing);
  const float most = std::max(turn_i, turn_j);
  if (most == 0) return distance - spacing;
  // The flatter side wins: its particles have more of their body on one side.
  const float cube_i = i.depth * i.depth * i.depth, cube_j = j.depth * j.depth * j.depth;
  const float wi = turn_i * cube_j, wj = turn_j * cube_i;
  const Vec3 out = (cube_i > 0 && cube_j > 0) ? Vec3((wj * j.outward - wi * i.outward) / (wi + wj))
                   : cube_i > 0               ? Vec3(-i.outward)
                                              : j.outward;
  normal = ((1 - most) * along + most * out).normalized();
  const float height = r.dot(normal), across = k_across * spacing;
  if (square - height * height > across * across) return k_never;
  return height - spacing;
}

/// Adds the pair of two points, seen from p, if they may touch in this step.
void add_pair(std::uint32_t p, std::uint32_t q, const BodyContactStep& step, const ContactPairs& pairs,
              std::vector<ContactPair>& found) {
  const ContactPoint &own = pairs.points[p], &other = pairs.points[q];
  const Vec3 r = own.position - other.position;
  const float closing = (pairs.velocity[p].velocity - pairs.velocity[q].velocity).norm();
  const float spacing = own.half_spacing + other.half_spacing, across = k_across * spacing;
  const float most = step.time_step * closing + pushed_together(step), along = spacing + most;
  if (!(r.squaredNorm() <= across * across + along * along)) return;
  if (own.inverse_mass == 0 && other.inverse_mass == 0) return;
  Vec3 normal = Vec3::Zero();
  const float gap = gap_between(own, other, r, spacing, normal);
  if (!(gap <= most)) return;
  float target = -gap / step.time_step;
  if (gap < 0)
    target = std::clamp(k_correction * (target - k_slop * spacing / step.time_step), 0.0f, step.max_push);
  const float stress = gap < k_sticking * spacing ? own.adhesion * other.adhesion : 0;
  found.push_back({normal, target, stress * spacing * spacing * step.time_step, q});
}

/// So much wider than they would be where nothing rounds are the tests by which points are left out.
constexpr float k_wider = 1.001f;

/// How far a point may move in this step, seen from a frame that moves with `velocity`.
float way(const ContactPairs& pairs, std::uint32_t point, const Vec3& velocity, const BodyContactStep& step) {
  return k_wider * step.time_step * (pairs.velocity[point].velocity - velocity).norm();
}

/// Points of other blocks in the box of one, those of each behind the other's.
struct Candidates {
  std::vector<std::uint32_t> name;
  std::vector<float> x, y, z, along;
  std::vector<std::uint32_t> end;  ///< of those of each block
  std::vector<std::uint32_t> meeting;

  void gather(std::size_t number, const BodyContactStep& step, const MeetingLanes& lanes,
              const ContactPairs& pairs) {
    const NearBlocks& near = pairs.near;
    const Moving& own = near.block_motion[number];
    const float half_spacing = pairs.points[near.first_point[number]].half_spacing;
    end.clear();
    std::size_t count = 0;
    for (const auto& [other, reach] : near.others[number]) {
      const std::uint32_t first = near.first_point[other], last = near.first_point[other + 1];
      const std::size_t before = count;
      resize(count + (last - first) + k_cluster);
      const Vec3 low = own.box.min.array() - reach, high = own.box.max.array() + reach;
      count += lanes.in_box(raw(pairs.positions), first, last, low.data(), high.data(), name.data() + count);
      for (std::size_t k = before; k < count; ++k) {
        const std::uint32_t q = name[k];
        x[k] = pairs.positions.x()[q];
        y[k] = pairs.positions.y()[q];
        z[k] = pairs.positions.z()[q];
        along[k] = k_wider * (half_spacing + pairs.points[q].half_spacing + pushed_together(step)) +
                   way(pairs, q, own.velocity, step);
      }
      end.push_back(static_cast<std::uint32_t>(count));
    }
  }
  MeetingPoints from(std::size_t k) const {
    return {name.data() + k, {x.data() + k, y.data() + k, z.data() + k}, along.data() + k};
  }

 private:
  void resize(std::size_t size) {
    if (name.size() >= size) return;
    for (std::vector<std::uint32_t>* names : {&name, &meeting}) names->resize(size);
    for (std::vector<float>* axis : {&x, &y, &z, &along}) axis->resize(size);
  }
};

/// The pairs of the points of a block.
void find_pairs(std::size_t number, const BodyContactStep& step, const MeetingLanes& lanes,
                ContactPairs& pairs) {
  const NearBlocks& near = pairs.near;
  const std::uint32_t begin = near.first_point[number], end = near.first_point[number + 1];
  BlockPairs& block = pairs.blocks[number];
  block.points.clear();
  block.pairs.clear();
  if (begin == end) return;
  block.points.reserve(k_block);
  block.pairs.reserve(k_room * (end - begin));
  thread_local Candidates candidates;
  candidates.gather(number, step, lanes, pairs);
  for (std::uint32_t p = begin; p < end; ++p) {
    const ContactPoint& own = pairs.points[p];
    const float own_way = way(pairs, p, near.block_motion[number].velocity, step);
    const std::size_t before = block.pairs.size();
    std::uint32_t next = 0;
    for (std::size_t o = 0; o < near.others[number].size(); ++o) {
      const auto& [other, reach] = near.others[number][o];
      const std::uint32_t first = std::exchange(next, candidates.end[o]);
      if (first == next || !is_near(own.position, near.block_motion[other].box, reach)) continue;
      const float across =
          k_wider * k_across * (own.half_spacing + pairs.points[candidates.name[first]].half_spacing);
      const std::size_t count = lanes.meeting(candidates.from(first), next - first, own.position.data(),
                                              own_way, across, candidates.meeting.data());
      for (std::size_t k = 0; k < count; ++k) add_pair(p, candidates.meeting[k], step, pairs, block.pairs);
    }
    if (block.pairs.size() > before)
      block.points.push_back({p, static_cast<std::uint32_t>(block.pairs.size() - before)});
  }
}

}  // namespace

std::size_t ContactPairs::bytes() const {
  std::size_t sum = near.bytes() + positions.bytes() + points.capacity() * sizeof(ContactPoint) +
                    (velocity.capacity() + next_velocity.capacity()) * sizeof(ContactVelocity);
  for (const BlockPairs& block : blocks)
    sum += block.points.capacity() * sizeof(BlockPairs::Touching) +
           block.pairs.capacity() * sizeof(ContactPair) + block.got.capacity() * sizeof(Vec3);
  return sum;
}

bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs) {
  find_near_blocks(positions, velocities, bodies, step, execution, pairs.near);
  if (pairs.near.row.empty()) return false;
  gather(positions, velocities, pin, bodies, execution.threads, pairs);
  pairs.blocks.resize(pairs.near.blocks.blocks.size());
  const MeetingLanes& lanes = MALLOW_SELECT(execution.level, meeting_lanes);
  parallel_for(execution.threads, pairs.near.blocks, [&](const RangeBlocks::Block&, std::size_t number) {
    find_pairs(number, step, lanes, pairs);
  });
  return std::ranges::any_of(pairs.blocks, [](const BlockPairs& block) { return !block.pairs.empty(); });
}

}  // namespace mallow

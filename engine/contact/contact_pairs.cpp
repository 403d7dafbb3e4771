#include "contact/contact_pairs.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "shape_matching/run_tables.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

/// Points that one thread handles at a time.
constexpr std::size_t k_point_block = 64;
/// Pairs of a point that there is room for from the start: more than rest or flow asks for, so that a motion
/// that goes on takes no more memory.
constexpr std::size_t k_room = 16;
/// A pair counts only where its points lie above each other: how far apart across n, in d0.
constexpr float k_across = 0.75f;

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

/// How far a point may come in this step: by what it moves, and by some of what others push it.
float way(float speed, const BodyContactStep& step) {
  return step.time_step * (speed + 0.125f * step.max_push);
}

/// The mean of the velocities that are numbers: all speeds are seen from it, as what moves together does not
/// meet.
Vec3 mean_velocity(const VectorColumn& velocities, const Threads& threads, ContactPairs& pairs) {
  const auto sum = [&](std::size_t begin, std::size_t end) {
    Vec3 velocity = Vec3::Zero();
    for (std::size_t p = begin; p < end; ++p) velocity += velocities.get(p);
    return velocity;
  };
  const auto add = [](const Vec3& a, const Vec3& b) { return Vec3(a + b); };
  const Vec3 mean =
      parallel_reduce(threads, velocities.size(), pairs.partial_velocity, Vec3(0, 0, 0), sum, add) /
      static_cast<float>(velocities.size());
  return mean.allFinite() ? mean : Vec3(0, 0, 0);
}

/// The largest speed.
float fastest_of(const VectorColumn& velocities, const Vec3& mean, const Threads& threads,
                 ContactPairs& pairs) {
  const auto speed = [&](std::size_t begin, std::size_t end) {
    float fastest = 0;
    for (std::size_t p = begin; p < end; ++p)
      fastest = std::max(fastest, (velocities.get(p) - mean).squaredNorm());
    return fastest;
  };
  const auto larger = [](float a, float b) { return std::max(a, b); };
  return std::sqrt(parallel_reduce(threads, velocities.size(), pairs.partial_speed, 0.0f, speed, larger));
}

/// Points that are farther apart than this do not touch while they are `farthest` from it along n.
float meeting_distance(float spacing, float farthest) {
  const float across = k_across * spacing, along = spacing + farthest;
  return 1.001f * std::sqrt(across * across + along * along);
}

/// Points in the order of the grid, and what is known of them.
void gather(const VectorColumn& velocities, const Vec3& mean, const std::uint16_t* pin,
            const std::vector<TouchingBody>& bodies, const BodyContactStep& step, const Threads& threads,
            ContactPairs& pairs) {
  const std::size_t n = pairs.near.row.size();
  for (Column<std::uint32_t>* column : {&pairs.row, &pairs.group}) column->resize_unset(n);
  for (Column<float>* column : {&pairs.half_spacing, &pairs.half_reach}) column->resize_unset(n);
  pairs.points.resize(n);
  pairs.velocity.resize(n);
  pairs.next_velocity.resize(n);
  parallel_for(
      threads, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
          const std::uint32_t from = pairs.grid.order[p], row = pairs.near.row[from];
          const TouchingBody& body = bodies[pairs.near.body[from]];
          const Vec3 v = velocities.get(row), out = outward(body, row);
          const float depth = out.norm();
          pairs.row[p] = row;
          pairs.group[p] = body.group;
          pairs.half_spacing[p] = 0.5f * body.spacing;
          pairs.half_reach[p] = 0.5f * body.spacing + way((v - mean).norm(), step);
          pairs.velocity[p] = {v, 0};
          pairs.points[p] = {.position = pairs.grid.sorted.get(p),
                             .outward = depth > 0 ? Vec3(out / depth) : Vec3(0, 0, 0),
                             .depth = depth,
                             .inverse_mass = pin && pin[row] != 0 ? 0.0f : 1.0f / body.mass,
                             .friction = std::sqrt(body.friction)};
        }
      },
      k_point_block);
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

/// Leaves in a point's list those of other bodies that may be near enough to touch in this step; most of a
/// list goes, in no order that a branch could foresee.
void keep_near(std::size_t p, ContactPairs& pairs) {
  std::uint32_t* const list = pairs.lists.indices.data() + pairs.lists.begin[p];
  const std::uint32_t count = pairs.lists.count[p], group = pairs.group[p];
  const ConstVectors x = raw(std::as_const(pairs.grid.sorted));
  const float *half = pairs.half_spacing.data(), *reach = pairs.half_reach.data();
  const float own_x = x.x[p], own_y = x.y[p], own_z = x.z[p], own_half = half[p], own_reach = reach[p];
  std::uint32_t kept = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t q = list[k];
    const float dx = x.x[q] - own_x, dy = x.y[q] - own_y, dz = x.z[q] - own_z;
    const float across = k_across * (own_half + half[q]), along = own_reach + reach[q];
    list[kept] = q;
    kept += static_cast<std::uint32_t>(group != pairs.group[q]) &
            static_cast<std::uint32_t>(dx * dx + dy * dy + dz * dz <= across * across + along * along);
  }
  pairs.lists.count[p] = kept;
}

/// So much more than what is needed that a motion that goes on takes memory now and then, not in every step.
void make_room(std::size_t points, ContactPairs& pairs) {
  const std::size_t blocks = (points + k_point_block - 1) / k_point_block;
  if (pairs.found.size() >= blocks) return;
  pairs.found.resize(blocks + blocks / 4 + 1);
  for (std::vector<ContactPair>& found : pairs.found) found.reserve(k_room * k_point_block);
  pairs.pairs.reserve(k_room * k_point_block * pairs.found.size());
}

/// Adds a pair for each in a point's list that it may touch, and writes how many.
void find_meeting(std::size_t p, const BodyContactStep& step, ContactPairs& pairs,
                  std::vector<ContactPair>& found) {
  const std::size_t before = found.size();
  const ContactPoint& own = pairs.points[p];
  for (const std::uint32_t q : pairs.lists.of(p)) {
    const ContactPoint& other = pairs.points[q];
    if (own.inverse_mass == 0 && other.inverse_mass == 0) continue;
    Vec3 normal = Vec3::Zero();
    const float spacing = pairs.half_spacing[p] + pairs.half_spacing[q];
    const float gap = gap_between(own, other, own.position - other.position, spacing, normal);
    if (!(gap <= pairs.half_reach[p] + pairs.half_reach[q] - spacing)) continue;
    float target = -gap / step.time_step;
    if (gap < 0) target = std::min(target, step.max_push);
    found.push_back({normal, target, q});
  }
  pairs.lists.count[p] = static_cast<std::uint32_t>(found.size() - before);
}

/// What blocks found, one behind the other.
bool join(const Threads& threads, ContactPairs& pairs) {
  const std::size_t n = pairs.points.size();
  pairs.first.resize_unset(n + 1);
  pairs.touching.resize_unset(n);
  std::uint32_t total = 0, touching = 0;
  for (std::size_t p = 0; p < n; ++p) {
    pairs.first[p] = total;
    total += pairs.lists.count[p];
    pairs.touching[touching] = static_cast<std::uint32_t>(p);
    touching += pairs.lists.count[p] > 0;
  }
  pairs.first[n] = total;
  pairs.touching.resize(touching);
  pairs.pairs.resize(total);
  parallel_for(
      threads, n,
      [&](std::size_t begin, std::size_t) {
        const std::vector<ContactPair>& found = pairs.found[begin / k_point_block];
        std::copy(found.begin(), found.end(),
                  pairs.pairs.begin() + static_cast<std::ptrdiff_t>(pairs.first[begin]));
      },
      k_point_block);
  return total > 0;
}

}  // namespace

std::size_t ContactPairs::bytes() const {
  return near.bytes() + grid.bytes() + lists.bytes() + touching.bytes() + first.bytes() + row.bytes() +
         positions.bytes() + 2 * pairs.capacity() * sizeof(ContactPair) +
         points.capacity() * sizeof(ContactPoint) +
         (velocity.capacity() + next_velocity.capacity()) * sizeof(ContactVelocity);
}

bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs) {
  const Vec3 mean = mean_velocity(velocities, execution.threads, pairs);
  const float fastest = fastest_of(velocities, mean, execution.threads, pairs);
  const float spacing = std::ranges::max(bodies, {}, &TouchingBody::spacing).spacing;
  const float reach = std::min(step.reach, meeting_distance(spacing, 2 * way(fastest, step)));
  find_near_bodies(positions, bodies, reach, execution, pairs.near);
  const std::size_t n = pairs.near.row.size();
  if (n == 0) return false;
  pairs.positions.resize_unset(n);
  parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) pairs.positions.set(p, positions.get(pairs.near.row[p]));
  });
  build_cell_grid(pairs.positions, 0, n, reach, execution, pairs.grid);
  // Of few points any thread may search all: room for that, or who is first decides whether memory is taken.
  if (pairs.lists.indices.size() < 128 * n) pairs.lists.indices.resize_unset(256 * n);
  build_neighbor_lists(pairs.grid, reach, execution, pairs.lists);
  gather(velocities, mean, pin, bodies, step, execution.threads, pairs);
  make_room(n, pairs);
  parallel_for(
      execution.threads, n,
      [&](std::size_t begin, std::size_t end) {
        std::vector<ContactPair>& found = pairs.found[begin / k_point_block];
        found.clear();
        for (std::size_t p = begin; p < end; ++p) {
          keep_near(p, pairs);
          find_meeting(p, step, pairs, found);
        }
      },
      k_point_block);
  return join(execution.threads, pairs);
}

}  // namespace mallow

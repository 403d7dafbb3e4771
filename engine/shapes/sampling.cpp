#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "core/precision.h"
#include "mallow/body.h"

namespace mallow {
namespace {

const std::string k_too_many = std::to_string(k_most_particles) + " points at most";
constexpr double k_most_cells = 1e9;

/// Distance functions may be this much steeper than true distances and are still sampled correctly.
constexpr float k_steepest = 1.5f;

using Index = std::array<std::int64_t, 3>;

/// A cubic lattice that is symmetric to the middle of a shape's bounds and ends within them.
struct Grid {
  Eigen::Vector3d first;
  double spacing;
  Index count;

  Vec3 point(const Index& i) const {
    return (first + spacing * Eigen::Array3d(double(i[0]), double(i[1]), double(i[2])).matrix())
        .cast<float>();
  }
};

constexpr double k_centimetre = 0.01;

/// Why a spacing gives more points than there may be. Who reads it may have taken centimetres for metres.
std::string too_fine(const Aabb& bounds, double spacing, const std::string& what) {
  const double width = static_cast<double>((bounds.max - bounds.min).maxCoeff());
  std::ostringstream text;
  text << spacing << " is not allowed: the shape is " << width << " m wide, " << width / spacing
       << " spacings, and " << what
       << "; give a spacing that suits its width, or the width that it is meant to have, "
       << k_centimetre * width << " where it is in centimetres";
  return text.str();
}
std::string too_many_cells() {
  std::ostringstream text;
  text << "its bounds would hold more than " << k_most_cells << " lattice points";
  return text.str();
}

/// Bit `axis` of `alignment` is set where the middle of the bounds is a lattice point, clear where it is
/// halfway between two.
Grid grid_within(const Aabb& bounds, float spacing, unsigned alignment) {
  Grid grid{Eigen::Vector3d::Zero(), spacing, {}};
  double cells = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * (double(bounds.max[axis]) - double(bounds.min[axis]));
    const bool on_point = (alignment >> axis) & 1u;
    const double count =
        on_point ? 2.0 * std::floor(half / spacing) + 1.0 : 2.0 * std::floor(half / spacing + 0.5);
    cells *= std::max(count, 1.0);
    if (cells > k_most_cells) throw ConfigError("spacing", too_fine(bounds, spacing, too_many_cells()));
    grid.first[axis] = double(bounds.min[axis]) + half - 0.5 * (count - 1.0) * spacing;
    grid.count[std::size_t(axis)] = static_cast<std::int64_t>(count);
  }
  return grid;
}

/// The lattice points of [begin, end).
struct Block {
  Index begin, end;
  std::int64_t size() const { return (end[0] - begin[0]) * (end[1] - begin[1]) * (end[2] - begin[2]); }
};

/// Calls visit(block) for blocks of lattice points that lie inside and hold every such point once. A block
/// whose middle is farther from the surface than its corners are from the middle is settled by that one
/// distance.
template <class Visit>
void visit_inside(const DistanceFunction& distance, const Grid& grid, const Block& block,
                  const Visit& visit) {
  if (block.size() == 0) return;
  const Vec3 low = grid.point(block.begin);
  const Vec3 high = grid.point({block.end[0] - 1, block.end[1] - 1, block.end[2] - 1});
  const bool single = block.size() == 1;
  const float reach = single ? 0.0f : k_steepest * 0.5f * (high - low).norm();
  const float d = distance(single ? low : Vec3(0.5f * (low + high)));
  if (d < -reach) return visit(block);
  if (single || d > reach) return;

  Index middle;
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = (block.begin[axis] + block.end[axis] + 1) / 2;
  for (unsigned part = 0; part < 8; ++part) {
    Block child = block;
    for (std::size_t axis = 0; axis < 3; ++axis)
      ((part >> axis) & 1u ? child.begin : child.end)[axis] = middle[axis];
    visit_inside(distance, grid, child, visit);
  }
}

template <class Visit>
void visit_inside(const ImplicitShape& shape, const Grid& grid, const Visit& visit) {
  visit_inside(shape.distance, grid, {{0, 0, 0}, grid.count}, visit);
}

std::int64_t count_inside(const ImplicitShape& shape, const Grid& grid) {
  std::int64_t count = 0;
  visit_inside(shape, grid, [&](const Block& block) { count += block.size(); });
  return count;
}

/// A lattice and the number of its points inside the shape.
struct Candidate {
  float spacing = 0;
  unsigned alignment = 0;
  std::int64_t count = 0;
};

bool within_1_percent(std::int64_t count, std::int64_t wanted) {
  return 100 * std::abs(count - wanted) <= wanted;
}

/// Looks for the spacing at which a shape holds a wanted number of points.
class SpacingSearch {
 public:
  SpacingSearch(const ImplicitShape& shape, std::int64_t wanted) : shape_(shape), wanted_(wanted) {}

  /// Symmetric shapes gain points by dozens as the spacing shrinks. Other alignments gain them elsewhere, so
  /// all are tried until one meets the number; the one without a point in the middle comes first.
  Candidate best() {
    const float start = guess();
    for (unsigned alignment : {0u, 7u, 1u, 2u, 4u, 3u, 5u, 6u}) {
      if (best_.count == wanted_) break;
      bisect(alignment, start);
    }
    return best_;
  }

 private:
  std::int64_t count(float spacing, unsigned alignment) {
    const std::int64_t found = count_inside(shape_, grid_within(shape_.bounds, spacing, alignment));
    if (std::abs(found - wanted_) < std::abs(best_.count - wanted_)) best_ = {spacing, alignment, found};
    return found;
  }

  /// The number of points goes with 1/spacing³, so a few corrections come close.
  float guess() {
    const double volume = (shape_.bounds.max - shape_.bounds.min).cast<double>().prod();
    double cells = double(wanted_);
    for (int correction = 0; correction < 6;) {
      const std::int64_t found = count(static_cast<float>(std::cbrt(volume / cells)), 0);
      if (within_1_percent(found, wanted_)) break;
      cells *= found == 0 ? 8.0 : double(wanted_) / double(found);
      if (found > 0) ++correction;
      if (cells > k_most_cells) {
        throw ConfigError(
            "count", std::to_string(wanted_) + " cannot be met: the shape fills too little of its bounds");
      }
    }
    return static_cast<float>(std::cbrt(volume / cells));
  }

  /// Closes in on a spacing at which the number passes the wanted one. At a relative width of 1e-5 the ends
  /// of the bracket differ by less than one in 30,000 points, unless points enter together.
  void bisect(unsigned alignment, float start) {
    float fine = start, coarse = start;
    while (count(fine, alignment) < wanted_) fine *= 0.99f;
    while (count(coarse, alignment) > wanted_) coarse *= 1.01f;
    while (best_.count != wanted_ && coarse - fine > 1e-5f * fine) {
      const float middle = 0.5f * (fine + coarse);
      (count(middle, alignment) > wanted_ ? fine : coarse) = middle;
    }
  }

  const ImplicitShape& shape_;
  std::int64_t wanted_;
  Candidate best_;
};

/// Throws ConfigError where floats cannot tell neighbouring points of a box apart.
void refuse_too_far(const char* field, const Aabb& box, float spacing) {
  const Vec3 farthest = (box.min.cwiseAbs().array() > box.max.cwiseAbs().array()).select(box.min, box.max);
  if (const auto why = why_too_far(farthest, spacing)) throw ConfigError(field, *why);
}

Candidate choose_lattice(const ImplicitShape& shape, const Sampling& sampling) {
  if (sampling.spacing) {
    const Grid grid = grid_within(shape.bounds, *sampling.spacing, 0);
    refuse_too_far("bounds", shape.bounds, *sampling.spacing);
    return {*sampling.spacing, 0, count_inside(shape, grid)};
  }
  const std::int64_t wanted = *sampling.count;
  const double box = (shape.bounds.max - shape.bounds.min).cast<double>().prod();
  refuse_too_far("bounds", shape.bounds, static_cast<float>(std::cbrt(box / double(wanted))));
  const Candidate best = SpacingSearch(shape, wanted).best();
  // Among less than 200 points 1% is less than the two by which symmetric shapes grow at the least.
  if (wanted >= 200 && !within_1_percent(best.count, wanted)) {
    throw ConfigError("count", std::to_string(wanted) +
                                   " cannot be met within 1%: the nearest number that fits is " +
                                   std::to_string(best.count));
  }
  return best;
}

/// Three numbers in [−1, 1) that depend on the lattice index alone (the mixer is that of SplitMix64, Steele,
/// Lea & Flood 2014): integers only, so every machine finds the same.
Vec3 random_vector(const Index& index) {
  std::uint64_t state = 0;
  const auto next = [&](std::uint64_t input) {
    state += input + 0x9e3779b97f4a7c15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return state = z ^ (z >> 31);
  };
  for (std::int64_t i : index) next(static_cast<std::uint64_t>(i));
  Vec3 offset;
  for (float& component : offset) component = static_cast<float>(next(0) >> 40) * 0x1p-23f - 1.0f;
  return offset;
}

/// The curl of the random vectors, by differences between the lattice points on either side; within ±1 per
/// axis. Its divergence is 0, so that what it displaces stays as dense as it was: a body at rest under a
/// stiff pressure_coefficient starts three to eight times as calmly as with the random vectors themselves.
Vec3 random_offset(const Index& index) {
  const auto difference = [&](std::size_t axis) -> Vec3 {
    Index before = index, after = index;
    --before[axis];
    ++after[axis];
    return random_vector(after) - random_vector(before);
  };
  const Vec3 dx = difference(0), dy = difference(1), dz = difference(2);
  return 0.25f * Vec3(dy.z() - dz.y(), dz.x() - dx.z(), dx.y() - dy.x());
}

/// Displaces a point that lies inside, and halves the displacement for as long as it leads outside.
Vec3 displace(const Vec3& point, Vec3 displacement, const DistanceFunction& distance) {
  Vec3 moved = point + displacement;
  while (moved != point && !(distance(moved) < 0.0f)) {
    displacement *= 0.5f;
    moved = point + displacement;
  }
  return moved;
}

/// Share of a shape's volume that points may miss, or exceed, without a word.
constexpr double k_volume_tolerance = 0.1;

double filled(double count, double spacing) {
  return count * spacing * spacing * spacing;
}

bool fills(double count, double spacing, double volume) {
  return std::abs(filled(count, spacing) - volume) <= k_volume_tolerance * volume;
}

/// What points of a lattice that miss the volume of a shape mean, and a spacing that does better.
std::string why_volume_differs(const ImplicitShape& shape, const Candidate& chosen) {
  std::ostringstream text;
  text << chosen.count << (chosen.count == 1 ? " point" : " points") << " with spacing " << chosen.spacing
       << " stand for a volume of " << filled(double(chosen.count), chosen.spacing) << ", but the shape's is "
       << *shape.volume << ": the spacing is too large for its size, or for its thin parts";
  // Each try holds twice the points of the one before.
  constexpr int k_tries = 24;
  constexpr std::int64_t k_most_tried = 4'000'000;
  const float finer = std::cbrt(0.5f);
  float spacing = chosen.spacing;
  for (int i = 0; i < k_tries; ++i) {
    spacing *= finer;
    if (filled(double(k_most_tried), spacing) < *shape.volume) break;
    if ((shape.bounds.max - shape.bounds.min).cast<double>().prod() / filled(1.0, spacing) > k_most_cells)
      break;
    const std::int64_t count = count_inside(shape, grid_within(shape.bounds, spacing, 0));
    if (!fills(double(count), spacing, *shape.volume)) continue;
    text << "; with " << spacing << " it has " << count << " points, which fit its volume";
    break;
  }
  return text.str();
}

void check(const ImplicitShape& shape, const Sampling& sampling) {
  Checks checks;
  const Aabb& bounds = shape.bounds;
  if (!shape.distance) checks.problem("distance", "none is given: a signed distance function");
  checks.vector("bounds.min", bounds.min);
  checks.vector("bounds.max", bounds.max);
  if (!(bounds.min.array() < bounds.max.array()).all())
    checks.problem("bounds", "the box is empty: min < max");
  if (sampling.spacing.has_value() == sampling.count.has_value()) {
    checks.problem("sampling", sampling.spacing ? "both spacing and count are given: one of them"
                                                : "neither spacing nor count is given: one of them");
  }
  check_fields("", sampling, checks);
  checks.finish();
}

}  // namespace

Body sample(const Lattice& lattice) {
  Checks checks;
  check_fields("", lattice, checks);
  double points = 1.0;
  for (const int count : lattice.count) points *= count;
  if (points > k_most_particles) checks.number("count", points, false, k_too_many);
  checks.finish();

  const auto [nx, ny, nz] = lattice.count;
  const Vec3 far_corner = lattice.corner + lattice.spacing * Vec3(float(nx), float(ny), float(nz));
  if (!far_corner.allFinite()) {
    throw ConfigError("spacing",
                      std::to_string(lattice.spacing) + " is not allowed: the last point is not finite");
  }
  refuse_too_far("corner", {lattice.corner, far_corner}, lattice.spacing);
  const Grid grid{
      lattice.corner.cast<double>().array() + 0.5 * double(lattice.spacing), lattice.spacing, {nx, ny, nz}};
  Body body;
  body.spacing = lattice.spacing;
  body.positions.reserve(static_cast<std::size_t>(points));
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) body.positions.push_back(grid.point({x, y, z}));
  if (lattice.jitter > 0.0f) {
    std::size_t k = 0;
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y)
        for (std::int64_t x = 0; x < nx; ++x)
          body.positions[k++] += lattice.jitter * lattice.spacing * random_offset({x, y, z});
  }
  return body;
}

Body sample(const ImplicitShape& shape, const Sampling& sampling) {
  check(shape, sampling);
  const Candidate chosen = choose_lattice(shape, sampling);
  if (chosen.count == 0) {
    std::ostringstream text;
    text << "no lattice point lies inside the shape";
    if (sampling.spacing) text << " at " << *sampling.spacing << ": a smaller spacing";
    throw ConfigError(sampling.spacing ? "spacing" : "count", text.str());
  }
  if (chosen.count > k_most_particles)
    throw ConfigError("spacing",
                      too_fine(shape.bounds, chosen.spacing,
                               std::to_string(chosen.count) + " points lie inside: " + k_too_many));

  const Grid grid = grid_within(shape.bounds, chosen.spacing, chosen.alignment);
  const float jitter = sampling.jitter * chosen.spacing;
  Body body;
  body.spacing = chosen.spacing;
  body.notes = shape.notes;
  if (shape.volume && !fills(double(chosen.count), chosen.spacing, *shape.volume))
    body.notes.push_back(why_volume_differs(shape, chosen));
  body.positions.reserve(static_cast<std::size_t>(chosen.count));
  visit_inside(shape, grid, [&](const Block& block) {
    Index i;
    for (i[2] = block.begin[2]; i[2] < block.end[2]; ++i[2])
      for (i[1] = block.begin[1]; i[1] < block.end[1]; ++i[1])
        for (i[0] = block.begin[0]; i[0] < block.end[0]; ++i[0]) {
          const Vec3 point = grid.point(i);
          body.positions.push_back(jitter > 0.0f ? displace(point, jitter * random_offset(i), shape.distance)
                                                 : point);
        }
  });
  return body;
}

}  // namespace mallow

#include "shape_matching/reshape.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/bounds.h"
#include "neighbors/neighbor_lists.h"
#include "shape_matching/list_sums.h"

namespace mallow {
namespace {

/// Sums of the reference shape are taken near its mean, which what came or went has moved. Only where it is
/// farther off than the body is large are all moved back: rounded anew, no list of theirs is known.
void center_reference(CarriedRegions& carried, ShapeMatching& shape) {
  VectorColumn& reference = shape.reference;
  const auto n = static_cast<double>(reference.size());
  const auto measure = [&](bool moves) {
    shape.total_moment = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      float* const x = reference.axis(a);
      double sum = 0;
      for (std::size_t i = 0; i < reference.size(); ++i) sum += static_cast<double>(x[i]);
      for (std::size_t i = 0; i < reference.size(); ++i) {
        const double centered = static_cast<double>(x[i]) - sum / n;
        if (moves) x[i] = static_cast<float>(centered);
        shape.total_moment += centered * centered / n;
      }
      shape.mean[static_cast<Eigen::Index>(a)] = moves ? 0 : sum / n;
    }
  };
  measure(false);
  if (shape.mean.squaredNorm() > shape.total_moment) {
    measure(true);
    forget_lists(carried);
  }
  shape.built = false;
}

Eigen::Quaternionf turn(const Eigen::Vector4f& rotation) {
  return Eigen::Quaternionf(rotation);
}

/// An added point, and what it is put beside, the nearest first: particles of the body, or, as behind these,
/// added points that are put somewhere before. It rests in the mean of where each of them would have it,
/// which evens out what their regions are turned by.
struct Beside {
  std::size_t added;
  std::size_t begin, end;  ///< of what it is put beside, in `of`
};
struct PutBeside {
  std::vector<Beside> order;
  std::vector<std::uint32_t> of;  ///< places in the body; of added points those behind it

  std::span<const std::uint32_t> beside(const Beside& one) const {
    return {of.data() + one.begin, one.end - one.begin};
  }
};

/// In which order added points are put beside what is within the region radius: first those beside
/// the body, then those beside these, and so on. Nothing is beside the rest.
PutBeside put_beside(const VectorColumn& positions, std::size_t begin, std::span<const Vec3> added,
                     const Execution& execution, const ShapeMatching& shape) {
  Aabb box = empty_box();
  for (const Vec3& x : added) box = box_around(box, {x, x});
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < shape.reference.size(); ++i)
    if (is_near(positions.get(begin + i), box, shape.region_radius))
      rows.push_back(static_cast<std::uint32_t>(i));
  const std::size_t n = rows.size();
  VectorColumn points(n + added.size());
  for (std::size_t k = 0; k < n; ++k) points.set(k, positions.get(begin + rows[k]));
  for (std::size_t k = 0; k < added.size(); ++k) {
    points.set(n + k, added[k]);
    rows.push_back(static_cast<std::uint32_t>(shape.reference.size() + k));
  }
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(points, 0, points.size(), shape.region_radius, execution, grid);
  build_neighbor_lists(grid, shape.region_radius, execution, lists);

  std::vector<bool> placed(points.size(), false);
  std::fill_n(placed.begin(), n, true);
  PutBeside put;
  std::vector<std::uint64_t> found;  // bits of a distance, which are in its order, and a row
  const auto find_beside = [&](std::size_t own, std::span<const std::uint32_t> list) {
    found.clear();
    for (const std::uint32_t t : list) {
      const std::size_t other = grid.order[t];
      if (!placed[other]) continue;
      const float distance = (points.get(own) - points.get(other)).squaredNorm();
      found.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32 | rows[other]);
    }
    // Of several as near the first, so that the order of a list does not matter.
    std::ranges::sort(found);
    if (found.empty()) return;
    put.order.push_back({own - n, put.of.size(), put.of.size() + found.size()});
    for (const std::uint64_t one : found) put.of.push_back(static_cast<std::uint32_t>(one));
  };
  for (std::size_t before = SIZE_MAX; put.order.size() < added.size() && put.order.size() != before;) {
    before = put.order.size();
    for (std::size_t s = 0; s < points.size(); ++s)
      if (const std::size_t own = grid.order[s]; !placed[own]) find_beside(own, lists.of(s));
    for (std::size_t k = before; k < put.order.size(); ++k) placed[n + put.order[k].added] = true;
  }
  for (std::size_t k = 0; k < added.size(); ++k)
    if (!placed[n + k]) put.order.push_back({k, 0, 0});
  return put;
}

/// Puts particles beside others that are in place already.
class RestBeside {
 public:
  RestBeside(const VectorColumn& positions, std::size_t begin, std::span<const std::uint8_t> yields,
             const Execution& execution, CarriedRegions& carried, ShapeMatching& shape)
      : x_(positions), begin_(begin), carried_(carried), shape_(shape), placed_(yields.size()) {
    build_cell_grid(positions, begin, begin + yields.size(), shape.region_radius, execution, grid_);
    build_neighbor_lists(grid_, shape.region_radius, execution, lists_);
    for (std::size_t s = 0; s < yields.size(); ++s) {
      placed_[grid_.order[s]] = yields[grid_.order[s]] == 0;
      if (yields[grid_.order[s]] != 0) left_.push_back(static_cast<std::uint32_t>(s));
    }
  }

  /// Goes outwards from those in place, as far as lists reach in one round; what nothing reaches starts from
  /// the nearest of all.
  void run() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    while (!left_.empty()) {
      found.clear();
      for (const std::uint32_t s : left_)
        if (const std::uint32_t beside = nearest(grid_.order[s], lists_.of(s)); beside != UINT32_MAX)
          found.emplace_back(grid_.order[s], beside);
      if (found.empty()) found.emplace_back(grid_.order[left_[0]], nearest_of_all(grid_.order[left_[0]]));
      for (const auto& [i, beside] : found) put(i, beside);
      std::erase_if(left_, [&](std::uint32_t s) { return placed_[grid_.order[s]]; });
    }
  }

 private:
  float squared_distance(std::uint32_t i, std::uint32_t k) const {
    return (x_.get(begin_ + i) - x_.get(begin_ + k)).squaredNorm();
  }
  /// Of several as near the first.
  void take_nearer(std::uint32_t i, std::uint32_t k, std::uint32_t& best, float& least) const {
    if (!placed_[k]) return;
    const float distance = squared_distance(i, k);
    if (distance > least || (distance == least && k > best)) return;
    least = distance;
    best = k;
  }
  std::uint32_t nearest(std::uint32_t i, std::span<const std::uint32_t> list) const {
    std::uint32_t best = UINT32_MAX;
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t t : list) take_nearer(i, grid_.order[t], best, least);
    return best;
  }
  std::uint32_t nearest_of_all(std::uint32_t i) const {
    std::uint32_t best = UINT32_MAX;
    float least = std::numeric_limits<float>::infinity();
    for (std::uint32_t k = 0; k < placed_.size(); ++k) take_nearer(i, k, best, least);
    return best;
  }
  void put(std::uint32_t i, std::uint32_t beside) {
    const Eigen::Vector4f rotation = carried_.rotations[beside];
    Vec3 arm = turn(rotation).conjugate() * (x_.get(begin_ + i) - x_.get(begin_ + beside));
    if (shape_.flows) {
      carried_.stretches[i] = {.stretch = carried_.stretches[beside].stretch};
      arm = carried_.stretches[i].stretch.inverse() * arm;
    }
    shape_.reference.set(i, shape_.reference.get(beside) + arm);
    carried_.rotations[i] = rotation;
    carried_.former[i] = FormerLists::k_none;
    carried_.news = box_around(carried_.news, box_around(shape_.reference, i, i + 1));
    placed_[i] = true;
  }

  const VectorColumn& x_;
  const std::size_t begin_;
  CarriedRegions& carried_;
  ShapeMatching& shape_;
  CellGrid grid_;
  NeighborLists lists_;
  std::vector<bool> placed_;
  std::vector<std::uint32_t> left_;  ///< sorted places of those that are not in place yet
};

/// ½ Σ w |x − goal|² of all regions [m²].
double energy_of(const std::vector<ReframedRegion>& regions, const VectorColumn& positions, std::size_t begin,
                 const ShapeMatching& shape) {
  std::vector<Numbers<8>> rows(shape.reference.size(), Numbers<8>::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector3d x = (positions.get(begin + i) - positions.get(begin)).cast<double>();
    const double w = static_cast<double>(shape.weight[i]);
    rows[i].head<5>() << w, w * x.x(), w * x.y(), w * x.z(), w * x.squaredNorm();
  }
  const std::vector<Numbers<8>> sums = sum_lists<8>(shape.regions, std::move(rows));
  double energy = 0;
  for (std::size_t j = 0; j < sums.size(); ++j) {
    const double moment = sums[j][4] - sums[j].segment<3>(1).square().sum() / sums[j][0];
    energy += 0.5 * std::max(0.0, moment + regions[j].fit);
  }
  return energy;
}

}  // namespace

CarriedRegions carry_regions(const ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  CarriedRegions carried{.rotations = std::vector<Eigen::Vector4f>(n),
                         .stretches = {},
                         .former = std::vector<std::uint32_t>(n),
                         .former_rows = n,
                         .news = empty_box()};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t region = shape.first_region(i);
    for (std::size_t k = 0; k < 4; ++k)
      carried.rotations[i][static_cast<Eigen::Index>(k)] = shape.rotation[k][region];
  }
  if (shape.flows)
    for (std::size_t i = 0; i < n; ++i)
      carried.stretches.push_back(carried_stretch(shape.plastic, shape.first_region(i)));
  std::iota(carried.former.begin(), carried.former.end(), 0u);
  return carried;
}

ReframedShape reframe_regions(const VectorColumn& positions, std::size_t begin, float yield, int iterations,
                              const Execution& execution, ShapeMatching& shape) {
  std::vector<ReframedRegion> reframed(shape.region_weight.size());
  MatchedBodies matched;
  matched.add(shape, begin);
  for (auto* bodies : {&matched.small, &matched.large})
    for (MatchedBodies::Body& body : *bodies) body.reframed = &reframed;
  match_shapes(positions, iterations, execution, matched);
  CarriedRegions carried = carry_regions(shape);
  std::ranges::fill(carried.rotations, Eigen::Vector4f(0, 0, 0, 1));
  for (std::size_t i = 0; i < carried.stretches.size(); ++i)
    carried.stretches[i] = {.stretch = reframed[shape.first_region(i)].stretch};
  carried.energy = energy_of(reframed, positions, begin, shape);
  forget_lists(carried);
  return {std::move(carried), is_strained_by_a_blow(reframed, yield, shape)};
}

void append_carried(const CarriedRegions& behind, CarriedRegions& carried) {
  const auto append = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  append(behind.rotations, carried.rotations);
  append(behind.stretches, carried.stretches);
  carried.former.resize(carried.rotations.size(), FormerLists::k_none);
  carried.energy += behind.energy;
  forget_lists(carried);
}

void forget_lists(CarriedRegions& carried) {
  const Vec3 all = Vec3::Constant(std::numeric_limits<float>::infinity());
  carried.news = {-all, all};
}

void sort_carried(std::span<const std::uint32_t> order, CarriedRegions& carried) {
  const auto sort = [&](auto& values) {
    auto sorted = values;
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = values[order[k]];
    values.swap(sorted);
  };
  sort(carried.rotations);
  if (!carried.stretches.empty()) sort(carried.stretches);
  sort(carried.former);
}

void build_carried(const CarriedRegions& carried, const Execution& execution, RegionScratch& scratch,
                   ShapeMatching& shape) {
  std::vector<Run> now(carried.former_rows, {FormerLists::k_none, 0});
  for (std::size_t i = 0; i < carried.former.size(); ++i)
    if (carried.former[i] != FormerLists::k_none) now[carried.former[i]] = {static_cast<std::uint32_t>(i), 1};
  for (std::size_t r = now.size(); r-- > 1;)
    if (now[r - 1].count > 0 && now[r - 1].first + 1 == now[r].first) now[r - 1].count += now[r].count;
  const bool known = shape.region_stride == 1 && carried.news.min.x() != -HUGE_VALF;
  if (known) copy_lists(shape.regions, scratch.former);
  const FormerLists former{scratch.former, carried.former, now, carried.news, shape.weight.span()};
  build_regions(execution, scratch, shape, known ? &former : nullptr);
  for (std::size_t j = 0; j < shape.region_weight.size(); ++j) {
    const std::size_t row = shape.first_row(j);
    for (std::size_t k = 0; k < 4; ++k)
      shape.rotation[k][j] = carried.rotations[row][static_cast<Eigen::Index>(k)];
    if (shape.flows && !carried.stretches.empty()) set_stretch(carried.stretches[row], j, shape.plastic);
  }
  if (std::isfinite(carried.energy)) bound_strain(carried.energy, shape);
}

void erase_from_reference(std::span<const std::uint32_t> places, CarriedRegions& carried,
                          ShapeMatching& shape) {
  shape.reference.erase(places);
  const auto erase = [&](auto& values) {
    close_gaps(values.data(), values.size(), places);
    values.resize(values.size() - places.size());
  };
  if (shape.built) {
    erase(carried.rotations);
    if (!carried.stretches.empty()) erase(carried.stretches);
    erase(carried.former);
  }
  center_reference(carried, shape);
}

SplitShape split_off(std::span<const std::uint32_t> places, const CarriedRegions& carried,
                     const ShapeMatching& whole) {
  SplitShape part;
  part.shape.region_radius = whole.region_radius;
  part.shape.region_stride = whole.region_stride;
  part.shape.spacing = whole.spacing;
  part.shape.flows = whole.flows;
  part.shape.frame = whole.frame;
  part.shape.reference.resize(places.size());
  part.carried.former.assign(places.size(), FormerLists::k_none);
  for (std::size_t k = 0; k < places.size(); ++k) {
    part.shape.reference.set(k, whole.reference.get(places[k]));
    part.carried.rotations.push_back(carried.rotations[places[k]]);
    if (!carried.stretches.empty()) part.carried.stretches.push_back(carried.stretches[places[k]]);
  }
  center_reference(part.carried, part.shape);
  forget_lists(part.carried);
  return part;
}

void rest_anew(const VectorColumn& positions, std::size_t begin, std::span<const std::uint8_t> yields,
               const Execution& execution, CarriedRegions& carried, ShapeMatching& shape) {
  RestBeside(positions, begin, yields, execution, carried, shape).run();
  center_reference(carried, shape);
}

void append_to_reference(const VectorColumn& positions, std::size_t begin, std::span<const Vec3> added,
                         const Execution& execution, CarriedRegions& carried, ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  const PutBeside beside = put_beside(positions, begin, added, execution, shape);
  Eigen::Vector3d middle(0, 0, 0);
  for (std::size_t i = 0; i < n; ++i)
    middle += positions.get(begin + i).cast<double>() / static_cast<double>(n);
  const Eigen::Vector4f whole = shape.frame.rotation.coeffs().cast<float>();
  shape.reference.resize(n + added.size());
  carried.rotations.resize(n + added.size());
  carried.former.resize(n + added.size(), FormerLists::k_none);
  if (shape.flows) carried.stretches.resize(n + added.size());
  const auto put = [&](std::size_t k, const Vec3& from, const Vec3& rest, const Eigen::Vector4f& rotation,
                       const CarriedStretch& stretch) {
    Vec3 away = turn(rotation).conjugate() * (added[k] - from);
    // Beside what has flowed it rests where nothing pulls at it: stretched as its neighbour is.
    if (shape.flows) away = stretch.stretch.inverse() * away;
    return Vec3(rest + away);
  };
  for (const Beside& one : beside.order) {
    const std::size_t k = one.added;
    const std::span<const std::uint32_t> of = beside.beside(one);
    CarriedStretch stretch{};
    if (shape.flows && !of.empty()) stretch.stretch = carried.stretches[of[0]].stretch;
    Eigen::Vector4f rotation = of.empty() ? whole : carried.rotations[of[0]];
    Vec3 rest(0, 0, 0);
    if (of.empty()) rest = put(k, middle.cast<float>(), shape.mean.cast<float>(), whole, stretch);
    for (std::size_t o = 0; o < of.size(); ++o) {
      const Eigen::Vector4f& other = carried.rotations[of[o]];
      const Vec3 from = of[o] < n ? positions.get(begin + of[o]) : added[of[o] - n];
      rest += put(k, from, shape.reference.get(of[o]), other, stretch) / static_cast<float>(of.size());
      if (o > 0) rotation += other.dot(carried.rotations[of[0]]) < 0 ? Eigen::Vector4f(-other) : other;
    }
    if (of.size() > 1) rotation.normalize();
    shape.reference.set(n + k, rest);
    carried.rotations[n + k] = rotation;
    if (shape.flows) carried.stretches[n + k] = stretch;
  }
  carried.news = box_around(carried.news, box_around(shape.reference, n, n + added.size()));
  center_reference(carried, shape);
}

}  // namespace mallow

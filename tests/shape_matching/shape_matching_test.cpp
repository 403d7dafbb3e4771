#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "levels.h"
#include "matrix_regions.h"
#include "shape_matching/parts.h"
#include "shape_matching/reshape.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace shape_matching_test {

constexpr int k_strides[] = {1, 2, 4, 8};

/// One group with irregular points and its regions.
struct World {
  VectorColumn x;
  ShapeMatching shape;
  RegionScratch scratch;

  explicit World(std::size_t n = 600, float side = 8, float radius = 2.0f, int stride = 1) : x(n) {
    shape.region_stride = stride;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> coordinate(0, side);
    for (std::size_t i = 0; i < n; ++i)
      x.set(i, {coordinate(random), coordinate(random), coordinate(random)});
    build(radius);
  }
  explicit World(const std::vector<Vec3>& points, float radius, int stride = 1) : x(points.size()) {
    shape.region_stride = stride;
    for (std::size_t i = 0; i < points.size(); ++i) x.set(i, points[i]);
    build(radius);
  }
  void build(float radius) {
    shape.region_radius = radius;
    update_reference(x, 0, x.size(), 2, scratch, shape);
    build_regions({2, best_instruction_level()}, scratch, shape);
  }
  void match(int threads = 2, InstructionLevel level = best_instruction_level(),
             int iterations = k_enough_iterations) {
    MatchedBodies bodies;
    bodies.add(shape, 0);
    match_shapes(x, iterations, {threads, level}, bodies);
  }
  template <class F>
  void transform(const F& f) {
    for (std::size_t i = 0; i < x.size(); ++i) x.set(i, f(x.get(i).cast<double>()).template cast<float>());
  }
  Eigen::Matrix3d rotation(std::size_t j) const {
    return Eigen::Quaternionf(shape.rotation[3][j], shape.rotation[0][j], shape.rotation[1][j],
                              shape.rotation[2][j])
        .cast<double>()
        .toRotationMatrix();
  }
};

World strided(int stride) {
  return World(600, 8, 2.0f, stride);
}

using Lists = std::vector<std::vector<std::size_t>>;

/// All pairs within the region radius of each particle.
Lists literal_neighbors(const World& world, const std::vector<Eigen::Vector3d>& reference) {
  Lists lists(reference.size());
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (std::size_t j = 0; j < lists.size(); ++j)
      if ((reference[i] - reference[j]).norm() <= static_cast<double>(world.shape.region_radius))
        lists[i].push_back(j);
  return lists;
}

/// Every particle that is drawn owns a region, and so does every particle that is in none of theirs.
std::vector<std::size_t> literal_owners(const Lists& neighbors, std::size_t stride) {
  const auto drawn = [&](std::size_t j) {
    return is_drawn(static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(stride));
  };
  std::vector<std::size_t> owners;
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    bool covered = false;
    for (std::size_t j = 0; j < neighbors.size(); ++j)
      covered = covered ||
                (drawn(j) && std::find(neighbors[j].begin(), neighbors[j].end(), i) != neighbors[j].end());
    if (drawn(i) || !covered) owners.push_back(i);
  }
  return owners;
}

/// Model section 2, literally: double, no frame; |N_i| counts the regions that are owned.
std::vector<Eigen::Vector3d> literal_pull(const World& world, const std::vector<Eigen::Vector3d>& reference) {
  const std::size_t n = world.x.size();
  const Lists neighbors = literal_neighbors(world, reference);
  const std::vector<std::size_t> owners =
      literal_owners(neighbors, static_cast<std::size_t>(world.shape.region_stride));
  std::vector<double> memberships(n);
  for (const std::size_t j : owners)
    for (const std::size_t i : neighbors[j]) ++memberships[i];
  std::vector<Eigen::Vector3d> goals(n, Eigen::Vector3d::Zero());
  const auto position = [&](std::size_t i) -> Eigen::Vector3d { return world.x.get(i).cast<double>(); };
  for (const std::size_t j : owners) {
    double total = 0;
    Eigen::Vector3d c(0, 0, 0), cr(0, 0, 0);
    for (const std::size_t i : neighbors[j]) {
      const double w = 1.0 / memberships[i];
      total += w;
      c += w * position(i);
      cr += w * reference[i];
    }
    c /= total;
    cr /= total;
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    for (const std::size_t i : neighbors[j])
      a += (position(i) - c) * (reference[i] - cr).transpose() / memberships[i];
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    const Eigen::Matrix3d r = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    for (const std::size_t i : neighbors[j]) goals[i] += (r * (reference[i] - cr) + c) / memberships[i];
  }
  for (std::size_t i = 0; i < n; ++i) goals[i] -= position(i);
  return goals;
}

std::vector<Eigen::Vector3d> points_of(const World& world) {
  std::vector<Eigen::Vector3d> points(world.x.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = world.x.get(i).cast<double>();
  return points;
}

double largest_pull(const World& world) {
  double largest = 0;
  for (std::size_t i = 0; i < world.x.size(); ++i)
    largest = std::max(largest, static_cast<double>(world.shape.pull.get(i).norm()));
  return largest;
}

TEST(regions, rigid_motion_gives_goal_equal_position) {
  for (const int stride : k_strides) {
    World world = strided(stride);
    const Eigen::AngleAxisd turn(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
    world.transform(
        [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x + Eigen::Vector3d(30, -10, 5); });
    world.match();
    // Positions themselves are rounded to 2e-6 at this distance from the origin.
    EXPECT_LT(largest_pull(world), 1e-5) << "stride " << stride;
  }
}

TEST(regions, rigid_motion_gives_goal_equal_position_at_a_large_body) {
  std::vector<Vec3> bar;
  for (int z = 0; z < 400; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) bar.push_back(Eigen::Vector3i(x, y, z).cast<float>());
  World world(bar, 2.5f);
  const Eigen::AngleAxisd turn(1.0, Eigen::Vector3d(1, 1, 0).normalized());
  world.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x; });
  world.match();
  // x ~ 400 is rounded to 3e-5.
  EXPECT_LT(largest_pull(world), 1e-4);
}

TEST(regions, of_a_stride_are_whole_and_leave_no_particle_out) {
  // A crowd, and points so far apart that most are alone.
  for (const float side : {8.0f, 40.0f}) {
    for (const int stride : {2, 4, 8, 1000}) {
      const World world(600, side, 2.0f, stride);
      const ShapeMatching& shape = world.shape;
      const Lists neighbors = literal_neighbors(world, points_of(world));
      const auto owners = literal_owners(neighbors, static_cast<std::size_t>(stride));
      ASSERT_EQ(shape.regions.count.size(), owners.size());
      ASSERT_EQ(shape.center.size(), owners.size());
      Lists memberships(world.x.size());
      for (std::size_t j = 0; j < owners.size(); ++j) {
        const auto coded = decode(shape.regions, j);
        std::vector<std::size_t> region(coded.begin(), coded.end());
        std::sort(region.begin(), region.end());
        EXPECT_EQ(region, neighbors[owners[j]]);
        for (const std::size_t i : region) memberships[i].push_back(j);
      }
      for (std::size_t i = 0; i < world.x.size(); ++i) {
        const auto coded = decode(shape.memberships, i);
        std::vector<std::size_t> mine(coded.begin(), coded.end());
        std::sort(mine.begin(), mine.end());
        EXPECT_EQ(mine, memberships[i]);
        EXPECT_FALSE(mine.empty());
      }
    }
  }
}

TEST(regions, of_a_stride_are_drawn_once_in_so_many_rows_and_in_no_column_of_a_lattice) {
  for (const std::uint32_t stride : {2u, 3u, 4u, 7u}) {
    std::vector<int> at_place(stride);
    for (std::uint32_t block = 0; block < 1000; ++block) {
      int drawn = 0;
      for (std::uint32_t k = 0; k < stride; ++k) {
        const bool here = is_drawn(block * stride + k, stride);
        drawn += here;
        at_place[k] += here;
      }
      EXPECT_EQ(drawn, 1);
    }
    const int expected = 1000 / static_cast<int>(stride);
    for (const int count : at_place) EXPECT_NEAR(count, expected, 60) << stride;
  }
}

TEST(regions, of_every_particle_need_no_second_list) {
  const World every = strided(1), fourth = strided(4);
  EXPECT_EQ(every.shape.regions.count.size(), every.x.size());
  EXPECT_EQ(every.shape.memberships.bytes(), 0u);
  EXPECT_LT(fourth.shape.regions.members, every.shape.regions.members / 3);
  EXPECT_EQ(fourth.shape.memberships.members, fourth.shape.regions.members);
  EXPECT_EQ(fourth.shape.average_neighbors, every.shape.average_neighbors);
}

/// Rows of a world in the order that regions are fast in, and what they carry along.
void sort_rows(World& world, CarriedRegions& carried) {
  sort_reference({2, best_instruction_level()}, world.scratch.pillars, world.shape);
  const auto order = world.scratch.pillars.order.span();
  VectorColumn sorted(world.x.size());
  for (std::size_t k = 0; k < order.size(); ++k) sorted.set(k, world.x.get(order[k]));
  world.x.swap(sorted);
  sort_carried(order, carried);
  build_carried(carried, {2, best_instruction_level()}, world.scratch, world.shape);
}

void append(World& world, const std::vector<Vec3>& points, CarriedRegions& carried) {
  append_to_reference(world.x, 0, points, {2, best_instruction_level()}, carried, world.shape);
  const std::size_t n = world.x.size();
  world.x.resize(n + points.size());
  for (std::size_t k = 0; k < points.size(); ++k) world.x.set(n + k, points[k]);
}

template <class T>
void expect_same(const Column<T>& a, const Column<T>& b) {
  EXPECT_TRUE(std::ranges::equal(a, b));
}

/// Lists and measures of a world have the bits of those that nothing was known of.
void expect_built_anew(const World& world) {
  ShapeMatching whole;
  whole.region_radius = world.shape.region_radius;
  whole.region_stride = world.shape.region_stride;
  whole.reference.resize(world.x.size());
  for (std::size_t i = 0; i < world.x.size(); ++i) whole.reference.set(i, world.shape.reference.get(i));
  RegionScratch scratch;
  build_regions({2, best_instruction_level()}, scratch, whole);
  for (const auto lists : {&ShapeMatching::regions, &ShapeMatching::memberships}) {
    expect_same((whole.*lists).begin, (world.shape.*lists).begin);
    expect_same((whole.*lists).count, (world.shape.*lists).count);
    expect_same((whole.*lists).entries, (world.shape.*lists).entries);
  }
  expect_same(whole.weight, world.shape.weight);
  expect_same(whole.region_weight, world.shape.region_weight);
  for (std::size_t k = 0; k < 6; ++k) expect_same(whole.moment[k], world.shape.moment[k]);
  for (std::size_t j = 0; j < whole.region_weight.size(); ++j)
    ASSERT_EQ(whole.center.get(j), world.shape.center.get(j));
}

TEST(regions, of_what_came_and_went_are_those_of_a_build_of_the_whole) {
  for (const int stride : {1, 3}) {
    SCOPED_TRACE(stride);
    World world(600, 8, 2.0f, stride);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> coordinate(0, 8);
    const auto some_points = [&](const Vec3& corner, std::size_t n) {
      std::vector<Vec3> points(n);
      for (Vec3& x : points)
        x = corner + 0.3f * Vec3(coordinate(random), coordinate(random), coordinate(random));
      return points;
    };
    for (int round = 0; round < 8; ++round) {
      SCOPED_TRACE(round);
      CarriedRegions carried = carry_regions(world.shape);
      if (round % 2 == 1) {
        std::vector<std::uint32_t> places;
        for (std::uint32_t i = 0; i < world.x.size(); ++i)
          if (i == 0 || random() % 9 == 0) places.push_back(i);
        erase_from_reference(places, carried, world.shape);
        world.x.erase(places);
      }
      // Inside, beside it, and so many beside it that the middle moves away.
      if (round != 3)
        append(world, some_points({2.0f * static_cast<float>(round), 3, 1}, round < 7 ? 20 : 3000), carried);
      EXPECT_EQ(carried.news.max.x() == HUGE_VALF, round == 7) << "lists that are known are taken";
      sort_rows(world, carried);
      expect_built_anew(world);
      world.match();
    }
  }
}

TEST(regions, of_a_body_that_loses_and_gains_some_are_measured_anew_beside_those_and_keep_the_bits) {
  World world(4000, 16, 2.0f);
  world.shape.spacing = 1;  // of pillars, which then stay as wide
  CarriedRegions unsorted = carry_regions(world.shape);
  sort_rows(world, unsorted);
  std::mt19937 random(7);
  for (int round = 0; round < 9; ++round) {
    SCOPED_TRACE(round);
    const bool loses = round % 3 != 2, gains = round % 3 != 0;
    CarriedRegions carried = carry_regions(world.shape);
    const auto place = static_cast<std::uint32_t>(random() % world.x.size());
    const Vec3 there = world.shape.reference.get(loses ? place : place / 2);
    if (loses) {
      erase_from_reference({&place, 1}, carried, world.shape);
      world.x.erase({&place, 1});
    }
    // One comes elsewhere, and takes the rows behind it up.
    if (gains) append(world, {world.x.get(place / 2) + Vec3(0.1f, 0.1f, 0)}, carried);
    sort_rows(world, carried);
    expect_built_anew(world);
    const auto& changed = world.scratch.changed;
    ASSERT_EQ(changed.size(), world.x.size());
    std::ptrdiff_t anew = 0, near = 0;
    for (std::size_t i = 0; i < world.x.size(); ++i) {
      const bool is_near = (world.shape.reference.get(i) - there).norm() <= (gains ? 5.0f : 4.0f);
      anew += changed[i];
      near += changed[i] != 0 && is_near;
    }
    EXPECT_GT(near, 0);
    EXPECT_LT(anew, loses && gains ? std::ssize(changed) / 2 : near + 1);
    world.match();
  }
}

TEST(parts, are_what_regions_join_at_every_stride_and_are_not_kept_beyond_their_regions) {
  for (const int stride : k_strides)
    for (const float radius : {1.0f, 1.5f, 3.0f}) {
      World world(700, 10, radius, stride);
      const auto literal = [&] {
        DisjointSets sets;
        sets.reset(world.x.size());
        for (std::size_t j = 0; j < world.shape.regions.count.size(); ++j) {
          const std::vector<std::uint32_t> rows = decode(world.shape.regions, j);
          for (const std::uint32_t row : rows) sets.join(rows.front(), row);
        }
        return sets;
      };
      Parts parts, again;
      for (int turn = 0; turn < 2; ++turn) {
        DisjointSets sets = literal();
        std::map<std::uint32_t, std::uint32_t> sizes;
        for (std::uint32_t i = 0; i < world.x.size(); ++i) ++sizes[sets.root(i)];
        find_parts(world.shape, parts);
        ASSERT_EQ(parts.count + parts.crumbs, sizes.size()) << stride << " " << radius;
        for (std::uint32_t i = 0; i < world.x.size(); ++i)
          ASSERT_EQ(parts.of[i], sizes[sets.root(i)] < k_crumb ? Parts::k_none : sets.root(i));
        keep_parts(parts, world.shape);
        find_parts(world.shape, again);
        ASSERT_EQ(again.of, parts.of);
        ASSERT_EQ(std::pair(again.count, again.crumbs), std::pair(parts.count, parts.crumbs));
        // Another shape: the half to the right is gone from the left one.
        for (std::size_t i = 0; i < world.x.size(); ++i)
          if (world.x.get(i)[0] > 5) world.x.set(i, world.x.get(i) + Vec3(20, 0, 0));
        world.build(radius);
      }
    }
}

TEST(parts, that_removed_particles_held_together_are_torn_where_all_parts_say_so) {
  World world(700, 10, 1.5f);  // hardly holds together
  CarriedRegions unsorted = carry_regions(world.shape);
  sort_rows(world, unsorted);
  std::mt19937 random(3);
  int torn_rounds = 0, whole_rounds = 0;
  Parts before, after, found;
  while (world.x.size() > 100) {
    find_parts(world.shape, before);
    std::vector<std::uint32_t> places;
    const std::size_t n = world.x.size(), first = random() % n;
    for (std::size_t i = first; i < std::min(first + 1 + random() % 6, n); i += 1 + random() % 2)
      places.push_back(static_cast<std::uint32_t>(i));
    const HeldTogether held = held_together_by(places, world.shape);
    CarriedRegions carried = carry_regions(world.shape);
    erase_from_reference(places, carried, world.shape);
    world.x.erase(places);
    sort_rows(world, carried);
    find_parts(world.shape, after);
    std::map<std::uint32_t, std::set<std::uint32_t>> parts_of;  // those before -> those after
    for (std::size_t i = 0; i < world.x.size(); ++i)
      if (after.of[i] != Parts::k_none) parts_of[before.of[carried.former[i]]].insert(after.of[i]);
    const bool torn = std::ranges::any_of(parts_of, [](const auto& part) { return part.second.size() > 1; });
    ASSERT_EQ(are_torn(held, carried.former, world.shape, found), torn) << world.x.size();
    (torn ? torn_rounds : whole_rounds) += 1;
  }
  EXPECT_GT(torn_rounds, 10);
  EXPECT_GT(whole_rounds, 50);
}

TEST(regions, of_a_body_that_grew_to_one_side_leave_it_alone_when_it_moves_as_a_rigid_whole) {
  World world(600, 8, 2.0f);
  CarriedRegions carried = carry_regions(world.shape);
  std::vector<Vec3> points;
  for (int k = 0; k < 300; ++k)
    points.push_back(Vec3(8.5f, 0, 0) + 0.9f * Eigen::Vector3i(k % 10, k / 10 % 6, k / 60).cast<float>());
  append(world, points, carried);
  sort_rows(world, carried);
  EXPECT_GT(world.shape.mean.norm(), 1);
  const Eigen::AngleAxisd turn(2.0, Eigen::Vector3d(1, 2, 3).normalized());
  world.transform(
      [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(turn * x + Eigen::Vector3d(5, -3, 2)); });
  world.match();
  for (std::size_t i = 0; i < world.x.size(); ++i) ASSERT_LT(world.shape.pull.get(i).norm(), 5e-6f);
}

TEST(shape_matching, equals_the_literal_sums_on_a_deformed_body) {
  for (const int stride : k_strides) {
    World world = strided(stride);
    const auto reference = points_of(world);
    std::mt19937 random(4);
    std::normal_distribution<double> normal(0, 0.2);
    world.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
      const Eigen::AngleAxisd twist(0.3 * x.z(), Eigen::Vector3d::UnitZ());
      return twist * Eigen::Vector3d(1.3 * x.x(), x.y(), 0.7 * x.z()) +
             Eigen::Vector3d(normal(random), normal(random), normal(random));
    });
    world.match();
    const auto expected = literal_pull(world, reference);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_LT((world.shape.pull.get(i).cast<double>() - expected[i]).norm(), 2e-5) << "stride " << stride;
  }
}

TEST(shape_matching, conserves_linear_and_angular_momentum) {
  for (const int stride : k_strides) {
    World world = strided(stride);
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, 0.3);
    world.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
      return x + Eigen::Vector3d(normal(random), normal(random), normal(random));
    });
    world.match();
    Eigen::Vector3d linear(0, 0, 0), angular(0, 0, 0);
    double size = 0, moment = 0;
    for (std::size_t i = 0; i < world.x.size(); ++i) {
      const Eigen::Vector3d x = world.x.get(i).cast<double>(), p = world.shape.pull.get(i).cast<double>();
      linear += p;
      angular += x.cross(p);
      size += p.norm();
      moment += x.norm() * p.norm();
    }
    EXPECT_LT(linear.norm(), 1e-6 * size) << "stride " << stride;
    EXPECT_LT(angular.norm(), 1e-6 * moment) << "stride " << stride;
  }
}

TEST(rotation, is_the_polar_factor_of_every_region_to_single_precision) {
  World world;
  world.transform([](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const Eigen::AngleAxisd twist(0.25 * x.y(), Eigen::Vector3d::UnitY());
    return twist * Eigen::Vector3d(1.5 * x.x() + 0.3 * x.y(), 0.8 * x.y(), x.z());
  });
  const auto reference = points_of(World());
  world.match();
  for (std::size_t j = 0; j < world.x.size(); ++j) {
    Eigen::Vector3d c(0, 0, 0), cr(0, 0, 0);
    double total = 0;
    for (const auto i : decode(world.shape.regions, j)) {
      const double w = static_cast<double>(world.shape.weight[i]);
      total += w;
      c += w * world.x.get(i).cast<double>();
      cr += w * reference[i];
    }
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    for (const auto i : decode(world.shape.regions, j))
      a += (world.x.get(i).cast<double>() - c / total) * (reference[i] - cr / total).transpose() *
           static_cast<double>(world.shape.weight[i]);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d r = svd.matrixU() * svd.matrixV().transpose();
    if (r.determinant() < 0 || svd.singularValues()[1] < 1e-2 * svd.singularValues()[0]) continue;
    const Eigen::Vector3d& s = svd.singularValues();
    // Rounding of A (a few 1e-7 of its size) turns the rotation by its share of the weakest pair of
    // directions.
    EXPECT_LT(Eigen::AngleAxisd(world.rotation(j).transpose() * r).angle(),
              4e-6 * std::max(1.0, s[0] / (s[1] + s[2])));
  }
}

TEST(rotation, never_mirrors_and_never_is_nan_on_mirrored_flat_and_collapsed_bodies) {
  const auto mirror = [](const Eigen::Vector3d& x) -> Eigen::Vector3d { return {-x.x(), x.y(), x.z()}; };
  const auto flatten = [](const Eigen::Vector3d& x) -> Eigen::Vector3d { return {x.x(), x.y(), 0}; };
  const auto line = [](const Eigen::Vector3d& x) -> Eigen::Vector3d { return {x.x(), 0, 0}; };
  const auto collapse = [](const Eigen::Vector3d&) -> Eigen::Vector3d { return {1, 2, 3}; };
  const auto check = [](World world) {
    world.match();
    for (std::size_t j = 0; j < world.x.size(); ++j) {
      ASSERT_NEAR(world.rotation(j).determinant(), 1.0, 1e-5);
      ASSERT_TRUE(world.shape.pull.get(j).allFinite());
    }
  };
  const auto transformed = [](const auto& f) {
    World world(300);
    world.transform(f);
    return world;
  };
  check(transformed(mirror));
  check(transformed(flatten));
  check(transformed(line));
  check(transformed(collapse));
}

/// Between the rotations of one region in two worlds [rad].
double angle_between(const World& a, const World& b, std::size_t j) {
  return Eigen::AngleAxisd(a.rotation(j).transpose() * b.rotation(j)).angle();
}
double largest_angle(const World& a, const World& b) {
  double largest = 0;
  for (std::size_t j = 0; j < a.x.size(); ++j) largest = std::max(largest, angle_between(a, b, j));
  return largest;
}

/// A world that was stretched and then turned about z by `angle` since it last matched.
World turned(double angle, int iterations, int threads = 2,
             InstructionLevel level = best_instruction_level()) {
  World world;
  world.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) *
           Eigen::Vector3d(1.3 * x.x(), x.y(), 0.8 * x.z());
  });
  world.match(threads, level, iterations);
  return world;
}

TEST(rotation, after_one_iteration_is_off_by_less_than_the_fifth_power_of_the_regions_turn) {
  for (const double angle : {0.02, 0.05, 0.1, 0.2, 0.4}) {
    // The stretch turns regions at the surface, which are not round, by up to 0.2 rad more.
    const World exact = turned(angle, 0), one = turned(angle, 1), two = turned(angle, 2);
    for (std::size_t j = 0; j < exact.x.size(); ++j) {
      const double turn = Eigen::AngleAxisd(exact.rotation(j)).angle();
      EXPECT_LT(angle_between(one, exact, j), std::pow(turn, 5) + 2e-6);
      EXPECT_LT(angle_between(two, exact, j), std::pow(turn, 25) + 2e-6);
    }
    EXPECT_LT(largest_angle(turned(angle, k_enough_iterations), exact), 2e-6);
  }
}

TEST(rotation, after_one_iteration_is_exact_where_a_round_region_only_turned) {
  // The middle of a lattice, where a region is the same along all axes.
  std::vector<Vec3> lattice;
  for (int k = 0; k < 343; ++k)
    lattice.push_back(Vec3(Eigen::Vector3i(k % 7, k / 7 % 7, k / 49).cast<float>()));
  World world(lattice, 2.5f);
  const Eigen::AngleAxisd turn(0.9, Eigen::Vector3d(1, 2, -1).normalized());
  world.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x; });
  world.match(2, best_instruction_level(), 1);
  EXPECT_LT(Eigen::AngleAxisd(turn.toRotationMatrix().transpose() * world.rotation(171)).angle(), 1e-6);
}

TEST(rotation, that_has_not_converged_goes_on_in_the_next_step) {
  const World exact = turned(0.6, 0);
  World world = turned(0.6, 1);
  EXPECT_GT(largest_angle(world, exact), 0.02);
  world.match(2, best_instruction_level(), 1);
  EXPECT_LT(largest_angle(world, exact), 1e-3);
  world.match(2, best_instruction_level(), 1);
  EXPECT_LT(largest_angle(world, exact), 2e-6);
}

TEST(rotation, is_exact_with_any_iterations_where_the_hessian_is_not_definite) {
  // Half a turn away from the last rotation, and flat, both at once.
  const auto half_turned = [](int iterations) {
    World world;
    world.transform([](const Eigen::Vector3d& x) -> Eigen::Vector3d { return {-x.x(), -x.y(), 0}; });
    world.match(2, best_instruction_level(), iterations);
    return world;
  };
  const World exact = half_turned(0);
  for (const int iterations : {1, 2, 7, k_enough_iterations}) {
    const World world = half_turned(iterations);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t j = 0; j < world.x.size(); ++j)
        ASSERT_EQ(world.shape.rotation[k][j], exact.shape.rotation[k][j]);
  }
}

TEST(rotation, has_the_same_bits_at_every_level_and_thread_count_for_any_iterations) {
  for (int iterations = 0; iterations <= k_enough_iterations; ++iterations) {
    const World reference = turned(0.7, iterations, 1, InstructionLevel::baseline);
    for (const InstructionLevel level : levels())
      for (const int threads : {1, 2, 3}) {
        const World world = turned(0.7, iterations, threads, level);
        for (std::size_t i = 0; i < world.x.size(); ++i)
          ASSERT_EQ(world.shape.pull.get(i), reference.shape.pull.get(i));
      }
  }
}

TEST(rotation, does_not_depend_on_the_regions_beside_it) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  // Turned little and much, stretched, mirrored; and no whole number of lanes.
  constexpr std::size_t n = 61;
  std::vector<Eigen::Matrix3d> matrices;
  std::vector<Eigen::Quaterniond> last;
  for (std::size_t j = 0; j < n; ++j) {
    const Eigen::Vector3d axis = Eigen::Vector3d(uniform(random), uniform(random), 2).normalized();
    const Eigen::Vector3d stretch(1.5, 1 + 0.5 * uniform(random), j % 7 == 0 ? -0.3 : 0.5);
    last.emplace_back(Eigen::AngleAxisd(3 * uniform(random), axis));
    matrices.push_back(last[j] * Eigen::AngleAxisd(std::pow(uniform(random), 3), axis.unitOrthogonal()) *
                       stretch.asDiagonal().toDenseMatrix());
  }
  for (const InstructionLevel level : levels()) {
    MatrixRegions together(n);
    for (std::size_t j = 0; j < n; ++j) together.set(j, matrices[j], last[j]);
    together.solve(level);
    for (std::size_t j = 0; j < n; ++j) {
      MatrixRegions alone(1);
      alone.set(0, matrices[j], last[j]);
      alone.solve(level);
      EXPECT_EQ(alone.row(0), together.row(j)) << "region " << j;
      // Padding stays inert.
      EXPECT_EQ(alone.shape.rotation[3].data()[1], 0);
      EXPECT_EQ(alone.shape.undecided.data()[1], 0);
    }
  }
}

TEST(rotation, of_a_collapsed_body_is_the_last_one) {
  World world(300);
  const Eigen::AngleAxisd turn(0.8, Eigen::Vector3d::UnitX());
  world.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x; });
  world.match();
  const Eigen::Matrix3d before = world.rotation(17);
  world.transform([](const Eigen::Vector3d&) -> Eigen::Vector3d { return {0, 0, 0}; });
  world.match();
  EXPECT_LT((world.rotation(17) - before).norm(), 1e-3);
}

TEST(regions, of_one_two_and_three_particles_pull_back_to_shape) {
  World one({{1, 2, 3}}, 2);
  one.match();
  EXPECT_EQ(largest_pull(one), 0);
  World two({{0, 0, 0}, {1, 0, 0}}, 2);
  two.x.set(1, {0, 0, 2});
  two.match();
  // Two of distance 2 that were 1 apart: each is drawn in by a half, wherever the line turned.
  EXPECT_LT((two.shape.pull.get(0) - Vec3(0, 0, 0.5f)).norm(), 1e-3f);
  EXPECT_LT((two.shape.pull.get(1) - Vec3(0, 0, -0.5f)).norm(), 1e-3f);
  World three({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 2);
  const Eigen::AngleAxisd turn(1.5, Eigen::Vector3d(1, 1, 1).normalized());
  three.transform([&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x; });
  three.match();
  EXPECT_LT(largest_pull(three), 1e-5);
}

TEST(shape_matching, conserves_linear_momentum_whatever_the_rotations_are) {
  // Too few iterations for a turn of 1.2 rad: the rotations are far off.
  const World world = turned(1.2, 1);
  Eigen::Vector3d linear(0, 0, 0);
  double size = 0;
  for (std::size_t i = 0; i < world.x.size(); ++i) {
    linear += world.shape.pull.get(i).cast<double>();
    size += world.shape.pull.get(i).cast<double>().norm();
  }
  EXPECT_LT(linear.norm(), 1e-6 * size);
}

TEST(shape_matching, has_the_same_bits_at_every_level_and_thread_count) {
  const auto deform = [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return Eigen::AngleAxisd(0.3 * x.z(), Eigen::Vector3d::UnitZ()) *
           Eigen::Vector3d(1.4 * x.x(), x.y(), x.z());
  };
  for (const int stride : k_strides) {
    World reference = strided(stride);
    reference.transform(deform);
    reference.match(1, InstructionLevel::baseline);
    for (const InstructionLevel level : levels()) {
      for (const int threads : {1, 2, 3}) {
        World world = strided(stride);
        world.transform(deform);
        world.match(threads, level);
        for (std::size_t i = 0; i < world.x.size(); ++i)
          ASSERT_EQ(world.shape.pull.get(i), reference.shape.pull.get(i));
      }
    }
  }
}

}  // namespace shape_matching_test
}  // namespace mallow

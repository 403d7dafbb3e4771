#include "shape_matching/run_tables.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "levels.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace run_tables_test {

struct Points {
  VectorColumn x;
  float spacing, radius;
};

Points lattice(int nx, int ny, int nz, float radius, float jitter = 0) {
  Points points{VectorColumn(static_cast<std::size_t>(nx * ny * nz)), 1.0f, radius};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> offset(-jitter, jitter);
  std::size_t i = 0;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x, ++i)
        points.x.set(i, Vec3(Eigen::Vector3i(x, y, z).cast<float>()) +
                            Vec3(offset(random), offset(random), offset(random)));
  return points;
}

Points cloud(std::size_t n, float side, float radius) {
  Points points{VectorColumn(n), 1.0f, radius};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(0, side);
  for (std::size_t i = 0; i < n; ++i)
    points.x.set(i, {coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

/// Two walls of pillars of one point each, and a stray that makes them pillars: of those near a point each is
/// a run of its own, as the other wall's lie between.
Points walls(int length, float radius) {
  Points points{VectorColumn(static_cast<std::size_t>(2 * length + 1)), 1.0f, radius};
  for (int k = 0; k < 2 * length; ++k)
    points.x.set(static_cast<std::size_t>(k), {0, k % 2 == 0 ? 0.0f : 6.0f, static_cast<float>(k / 2)});
  points.x.set(points.x.size() - 1, {1000, 3, 0});
  return points;
}

/// Bodies of which some have long runs, some short ones, and one a stray far away.
std::vector<Points> bodies() {
  std::vector<Points> all;
  all.push_back(lattice(14, 10, 20, 2.9f));
  all.push_back(lattice(9, 30, 9, 4.3f, 0.15f));
  all.push_back(lattice(200, 2, 1, 60.0f));
  all.push_back(lattice(1, 1, 1, 1.0f));
  all.push_back(walls(60, 4.5f));
  all.push_back(cloud(900, 9, 1.7f));
  all.push_back(cloud(700, 40, 1.5f));
  all.push_back(lattice(7, 7, 7, 1.5f));
  all.back().x.set(5, {1e6f, -3e5f, 2e4f});
  return all;
}

std::vector<std::uint32_t> literal_near(const VectorColumn& x, std::size_t i, float radius) {
  std::vector<std::uint32_t> near;
  for (std::size_t j = 0; j < x.size(); ++j)
    if ((x.get(i).cast<double>() - x.get(j).cast<double>()).norm() <= static_cast<double>(radius))
      near.push_back(static_cast<std::uint32_t>(j));
  return near;
}

std::vector<std::uint32_t> rows_of(std::span<const Run> runs) {
  std::vector<std::uint32_t> rows;
  for (const Run& run : runs)
    for (std::uint32_t k = 0; k < run.count; ++k) rows.push_back(run.first + k);
  return rows;
}

TEST(pillar_order, sorts_pillars_and_along_them_and_keeps_what_is_sorted) {
  for (const Points& points : bodies()) {
    PillarOrder pillars, again, threaded;
    const std::size_t n = points.x.size();
    order_by_pillars(points.x, 0, n, points.spacing, {1, best_instruction_level()}, pillars);
    std::vector<std::uint32_t> order(pillars.order.begin(), pillars.order.end());
    for (std::size_t c = 0; c < pillars.pillars(); ++c) {
      const float* const along = pillars.sorted.axis(static_cast<std::size_t>(pillars.along));
      EXPECT_TRUE(std::is_sorted(along + pillars.start[c], along + pillars.start[c + 1]));
    }
    for (std::size_t s = 0; s < n; ++s) EXPECT_EQ(pillars.sorted.get(s), points.x.get(order[s]));
    order_by_pillars(points.x, 0, n, points.spacing, {3, best_instruction_level()}, threaded);
    EXPECT_TRUE(std::equal(order.begin(), order.end(), threaded.order.begin()));
    order_by_pillars(pillars.sorted, 0, n, points.spacing, {2, best_instruction_level()}, again);
    EXPECT_TRUE(again.already);
    std::sort(order.begin(), order.end());
    for (std::size_t s = 0; s < n; ++s) EXPECT_EQ(order[s], s);
  }
}

TEST(run_lists, equal_brute_force_in_any_order_of_rows) {
  for (const Points& points : bodies()) {
    PillarOrder pillars;
    order_by_pillars(points.x, 0, points.x.size(), points.spacing, {2, best_instruction_level()}, pillars);
    const VectorColumn sorted = std::move(pillars.sorted);
    for (const VectorColumn* x : {&points.x, &sorted}) {
      PillarOrder order;
      order_by_pillars(*x, 0, x->size(), points.spacing, {2, best_instruction_level()}, order);
      for (const InstructionLevel level : levels()) {
        RunLists lists;
        find_runs(order, points.radius, {2, level}, lists);
        for (std::size_t i = 0; i < x->size(); ++i) {
          const auto expected = literal_near(*x, i, points.radius);
          ASSERT_EQ(rows_of(lists.of(i)), expected);
          ASSERT_EQ(lists.members[i], expected.size());
        }
      }
    }
  }
}

/// Lists of points whose rows are in the order of pillars, as the engine keeps them.
RunLists lists_in_pillar_order(const Points& points, int threads) {
  PillarOrder pillars;
  order_by_pillars(points.x, 0, points.x.size(), points.spacing, {threads, best_instruction_level()},
                   pillars);
  const VectorColumn x = std::move(pillars.sorted);
  order_by_pillars(x, 0, x.size(), points.spacing, {threads, best_instruction_level()}, pillars);
  RunLists lists;
  find_runs(pillars, points.radius, {threads, best_instruction_level()}, lists);
  return lists;
}

TEST(run_tables, hold_the_rows_of_the_lists_whatever_their_lengths) {
  for (const Points& points : bodies()) {
    const RunLists lists = lists_in_pillar_order(points, 2);
    TableLists coded;
    encode(lists, {}, points.x.size(), 2, coded);
    std::size_t members = 0;
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      ASSERT_EQ(decode(coded, i), rows_of(lists.of(i)));
      members += lists.members[i];
    }
    EXPECT_EQ(coded.members, members);
  }
}

TEST(run_tables, have_the_entries_of_the_example_in_their_header) {
  TableLists coded;
  coded.lengths = {{1, 2, 4}, 3};
  coded.rows = 8;
  for (Column<std::uint32_t>* column : {&coded.begin, &coded.count}) column->resize(1);
  coded.count[0] = 3;
  coded.entries.resize(3);
  const std::vector<std::uint32_t> entries = {0, 18, 14}, rows = {0, 2, 3, 4, 5, 6, 7};
  std::ranges::copy(entries, coded.entries.begin());
  EXPECT_EQ(decode(coded, 0), rows);
}

TEST(run_tables, cost_nothing_where_they_do_not_pay_and_little_where_they_do) {
  const auto entries = [](const Points& points, std::uint32_t& lengths) {
    const RunLists lists = lists_in_pillar_order(points, 1);
    TableLists coded;
    encode(lists, {}, points.x.size(), 1, coded);
    lengths = coded.lengths.count;
    return static_cast<double>(coded.total) / static_cast<double>(coded.members);
  };
  std::uint32_t lengths = 0;
  EXPECT_EQ(entries(cloud(700, 40, 1.5f), lengths), 1);
  EXPECT_EQ(lengths, 1u);
  // Table 1's bar: 755 neighbours of radius 7.2 spacings.
  EXPECT_LT(entries(lattice(36, 10, 10, 7.2f), lengths), 0.12);
  EXPECT_LE(lengths, k_max_lengths);
}

/// A body with tables, matched to a deformation of it.
struct Matched {
  VectorColumn x;
  ShapeMatching shape;

  template <class F>
  Matched(const Points& points, int stride, int threads, InstructionLevel level, const F& deform) {
    RegionScratch scratch;
    shape.region_radius = points.radius;
    shape.spacing = points.spacing;
    shape.region_stride = stride;
    update_reference(points.x, 0, points.x.size(), threads, scratch, shape);
    sort_reference({threads, best_instruction_level()}, scratch.pillars, shape);
    x.resize(points.x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      x.set(i, deform(points.x.get(scratch.pillars.order[i]).cast<double>()).template cast<float>());
    build_regions({threads, level}, scratch, shape);
    MatchedBodies bodies;
    bodies.add(shape, 0);
    match_shapes(x, k_enough_iterations, {threads, level}, bodies);
  }
};

Eigen::Vector3d bend(const Eigen::Vector3d& x) {
  return Eigen::AngleAxisd(0.05 * x.z(), Eigen::Vector3d::UnitX()) *
         Eigen::Vector3d(1.1 * x.x(), x.y(), x.z());
}

TEST(run_tables, give_the_same_bits_at_every_level_and_thread_count) {
  for (const Points& points : {lattice(14, 10, 20, 2.9f), lattice(9, 30, 9, 4.3f, 0.15f)})
    for (const int stride : {1, 2, 3}) {
      const Matched reference(points, stride, 1, InstructionLevel::baseline, bend);
      EXPECT_GT(reference.shape.regions.lengths.count, 1u);
      for (const InstructionLevel level : levels())
        for (const int threads : {1, 2, 3}) {
          const Matched other(points, stride, threads, level, bend);
          for (std::size_t i = 0; i < other.x.size(); ++i)
            ASSERT_EQ(other.shape.pull.get(i), reference.shape.pull.get(i));
        }
    }
}

TEST(run_tables, keep_momentum_and_leave_a_rigid_body_alone) {
  const Eigen::AngleAxisd turn(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
  for (const Points& points : {lattice(14, 10, 20, 2.9f), lattice(9, 30, 9, 4.3f, 0.15f)})
    for (const int stride : {1, 2, 3}) {
      const auto rigid = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x; };
      const Matched still(points, stride, 2, best_instruction_level(), rigid);
      for (std::size_t i = 0; i < still.x.size(); ++i) ASSERT_LT(still.shape.pull.get(i).norm(), 1e-5f);
      const Matched bent(points, stride, 2, best_instruction_level(), bend);
      Eigen::Vector3d linear(0, 0, 0), angular(0, 0, 0);
      double size = 0, moment = 0;
      for (std::size_t i = 0; i < bent.x.size(); ++i) {
        const Eigen::Vector3d x = bent.x.get(i).cast<double>(), p = bent.shape.pull.get(i).cast<double>();
        linear += p;
        angular += x.cross(p);
        size += p.norm();
        moment += x.norm() * p.norm();
      }
      EXPECT_LT(linear.norm(), 2e-6 * size) << stride;
      EXPECT_LT(angular.norm(), 2e-6 * moment) << stride;
    }
}

}  // namespace run_tables_test
}  // namespace mallow

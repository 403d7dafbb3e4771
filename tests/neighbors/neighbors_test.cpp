#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nanoflann.hpp>
#include <random>

#include "core/isa.h"
#include "levels.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"

namespace mallow {
namespace neighbors_test {

using Points = std::vector<Vec3>;

VectorColumn column(const Points& points) {
  VectorColumn x(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) x.set(i, points[i]);
  return x;
}

Points random_points(std::size_t n, float side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(0, side);
  Points points(n);
  for (Vec3& p : points) p = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

/// Lists by index of the points, each ascending.
std::vector<std::vector<std::uint32_t>> lists_of(const Points& points, float radius, int threads,
                                                 InstructionLevel level, std::size_t capacity = 0) {
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(column(points), 0, points.size(), radius, {threads, level}, grid);
  if (capacity > 0) lists.indices.resize(capacity);
  build_neighbor_lists(grid, radius, {threads, level}, lists);
  std::vector<std::vector<std::uint32_t>> result(points.size());
  std::size_t total = 0;
  for (std::size_t s = 0; s < points.size(); ++s) {
    auto& list = result[grid.order[s]];
    for (const std::uint32_t t : lists.of(s)) list.push_back(grid.order[t]);
    std::sort(list.begin(), list.end());
    total += list.size();
  }
  EXPECT_EQ(total, lists.total);
  return result;
}

struct Cloud {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// The same from nanoflann. Pairs within rounding of the radius may fall on either side, so points are chosen
/// without.
std::vector<std::vector<std::uint32_t>> oracle_lists(const Points& points, float radius) {
  const Cloud cloud{points};
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3,
                                                   std::uint32_t>;
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  tree.buildIndex();
  std::vector<std::vector<std::uint32_t>> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<std::pair<std::uint32_t, float>> found;
    tree.radiusSearch(points[i].data(), radius * radius, found, nanoflann::SearchParams());
    for (const auto& [index, distance] : found) result[i].push_back(index);
    std::sort(result[i].begin(), result[i].end());
  }
  return result;
}

TEST(neighbors, equals_nanoflann_on_random_points_at_every_level_and_thread_count) {
  const Points points = random_points(3000, 10, 1);
  const auto expected = oracle_lists(points, 1.1f);
  for (const InstructionLevel level : levels())
    for (const int threads : {1, 2, 3, 4}) EXPECT_EQ(lists_of(points, 1.1f, threads, level), expected);
}

TEST(neighbors, equals_nanoflann_on_coincident_points) {
  Points points = random_points(200, 5, 2);
  for (int k = 0; k < 300; ++k) points.push_back(points[7]);
  for (int k = 0; k < 20; ++k) points.push_back(points[static_cast<std::size_t>(k)]);
  EXPECT_EQ(lists_of(points, 1.3f, 2, best_instruction_level()), oracle_lists(points, 1.3f));
}

TEST(neighbors, equals_nanoflann_when_capacity_is_forced_too_small) {
  const Points points = random_points(2000, 8, 3);
  const auto expected = oracle_lists(points, 1.2f);
  for (const std::size_t capacity : {1u, 100u, 5000u})
    EXPECT_EQ(lists_of(points, 1.2f, 2, best_instruction_level(), capacity), expected);
}

TEST(neighbors, equals_nanoflann_where_few_points_stray_far_away) {
  Points points = random_points(1500, 6, 4);
  points.push_back({1e5f, 0, 0});
  points.push_back({1e5f, 0.5f, 0});
  points.push_back({-3e4f, 2e5f, -1e5f});
  EXPECT_EQ(lists_of(points, 1.0f, 2, best_instruction_level()), oracle_lists(points, 1.0f));
}

TEST(neighbors, finds_all_where_the_radius_spans_the_cloud_and_only_itself_where_it_is_tiny) {
  const Points points = random_points(300, 1, 5);
  for (const auto& list : lists_of(points, 10, 2, best_instruction_level()))
    EXPECT_EQ(list.size(), points.size());
  const auto lonely = lists_of(points, 1e-6f, 2, best_instruction_level());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(lonely[i], std::vector<std::uint32_t>{static_cast<unsigned>(i)});
}

/// Points that the list of their own cluster lacks although they are in the list of a point of it, and points
/// listed twice.
std::size_t cluster_list_faults(const Points& points, float radius, float spacing, int threads,
                                InstructionLevel level) {
  CellGrid grid;
  grid.spacing = spacing;
  NeighborLists lists, exact;
  build_cell_grid(column(points), 0, points.size(), radius, {threads, level}, grid);
  build_cluster_lists(grid, radius, {threads, level}, lists);
  build_neighbor_lists(grid, radius, {threads, level}, exact);
  std::size_t faults = 0, total = 0;
  for (std::size_t c = 0; c < grid.clusters(); ++c) {
    std::vector<std::uint32_t> list(lists.of(c).begin(), lists.of(c).end());
    std::sort(list.begin(), list.end());
    total += list.size();
    faults += std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) != list.end();
    for (std::size_t i = grid.cluster_start[c]; i < grid.cluster_start[c + 1]; ++i)
      for (const std::uint32_t j : exact.of(i)) faults += !std::binary_search(list.begin(), list.end(), j);
  }
  EXPECT_EQ(total, lists.total);
  return faults;
}

TEST(neighbors, the_list_of_a_cluster_holds_the_neighbors_of_its_points) {
  Points points = random_points(2000, 8, 7);
  points.push_back({1e5f, 0, 0});
  for (int k = 0; k < 30; ++k) points.push_back(points[7]);
  for (const float spacing : {0.0f, 0.1f, 0.6f, 5.0f})
    for (const InstructionLevel level : levels())
      EXPECT_EQ(cluster_list_faults(points, 1.2f, spacing, 2, level), 0u) << "spacing " << spacing;
}

TEST(neighbors, clusters_are_all_points_in_order_eight_at_most) {
  const Points points = random_points(3000, 9, 8);
  CellGrid grid;
  build_cell_grid(column(points), 0, points.size(), 1, {3, best_instruction_level()}, grid);
  EXPECT_EQ(grid.cluster_start[0], 0u);
  EXPECT_EQ(grid.cluster_start[grid.clusters()], points.size());
  for (std::size_t c = 0; c < grid.clusters(); ++c) {
    EXPECT_LT(grid.cluster_start[c], grid.cluster_start[c + 1]);
    EXPECT_LE(grid.cluster_start[c + 1] - grid.cluster_start[c], k_cluster);
  }
}

TEST(neighbors, what_is_found_does_not_depend_on_the_size_of_cells) {
  const Points points = random_points(1500, 7, 9);
  const auto expected = oracle_lists(points, 1.1f);
  for (const float spacing : {0.05f, 0.3f, 1.0f, 20.0f}) {
    CellGrid grid;
    grid.spacing = spacing;
    NeighborLists lists;
    build_cell_grid(column(points), 0, points.size(), 1.1f, {2, best_instruction_level()}, grid);
    build_neighbor_lists(grid, 1.1f, {2, best_instruction_level()}, lists);
    for (std::size_t s = 0; s < points.size(); ++s) {
      std::vector<std::uint32_t> list;
      for (const std::uint32_t t : lists.of(s)) list.push_back(grid.order[t]);
      std::sort(list.begin(), list.end());
      EXPECT_EQ(list, expected[grid.order[s]]);
    }
  }
}

/// Per point the list of its cluster, thinned to what is within the radius and one of the first `n`, in
/// order.
std::vector<std::vector<std::uint32_t>> ordered_lists(const CellGrid& grid, float radius, std::size_t n) {
  NeighborLists lists;
  build_cluster_lists(grid, radius, {2, best_instruction_level()}, lists);
  std::vector<std::vector<std::uint32_t>> result(n);
  for (std::size_t c = 0; c < grid.clusters(); ++c)
    for (std::size_t i = grid.cluster_start[c]; i < grid.cluster_start[c + 1]; ++i)
      for (const std::uint32_t j : lists.of(c))
        if (grid.order[i] < n && grid.order[j] < n &&
            (grid.sorted.get(i) - grid.sorted.get(j)).norm() < 0.999f * radius)
          result[grid.order[i]].push_back(grid.order[j]);
  return result;
}

TEST(neighbors, order_in_an_anchored_grid_does_not_depend_on_who_else_is_there) {
  constexpr float k_radius = 1.2f;
  for (const float middle : {0.0f, 40.0f, -3e4f}) {
    SCOPED_TRACE(middle);
    Points points = random_points(1500, 7, 9);
    for (Vec3& p : points) p += Vec3(middle - 3.3f, middle - 2.9f, middle - 3.1f);
    const std::size_t n = points.size();
    points.push_back(points[5] + Vec3(-18, -33.3f, -7));  // moves where the box begins, strips and all
    const Points some(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n));
    CellGrid with, without;
    with.spacing = without.spacing = 0.4f;
    with.anchored = without.anchored = true;
    without.points_beside = 1;
    without.box_beside = {points.back(), points.back()};
    build_cell_grid(column(points), 0, n + 1, k_radius, {1, InstructionLevel::baseline}, with);
    build_cell_grid(column(some), 0, n, k_radius, {2, best_instruction_level()}, without);
    ASSERT_EQ(with.along, without.along);
    const auto lists = ordered_lists(with, k_radius, n);
    EXPECT_EQ(lists, ordered_lists(without, k_radius, n));
    std::vector<std::uint32_t> order;
    std::ranges::copy_if(with.order, std::back_inserter(order), [&](std::uint32_t i) { return i < n; });
    EXPECT_TRUE(std::ranges::equal(order, without.order));
    const auto expected = oracle_lists(some, 0.998f * k_radius);
    for (std::size_t i = 0; i < n; ++i)
      for (const std::uint32_t j : expected[i])
        EXPECT_EQ(std::ranges::count(lists[i], j), 1) << i << ' ' << j;
  }
}

TEST(neighbors, cell_order_is_stable_at_every_level_and_thread_count) {
  // So many that several threads count, and a few that are clamped.
  Points points = random_points(70001, 10, 6);
  for (const float stray : {1e30f, -1e30f, HUGE_VALF, -HUGE_VALF, std::nanf("")})
    for (int axis = 0; axis < 3; ++axis) points[static_cast<std::size_t>(37 + axis) * 99][axis] = stray;
  const VectorColumn x = column(points);
  CellGrid one, other;
  build_cell_grid(x, 0, points.size(), 0.5f, {1, InstructionLevel::baseline}, one);
  for (std::size_t c = 0; c + 1 < one.cell_start.size(); ++c)
    EXPECT_TRUE(
        std::is_sorted(one.order.begin() + one.cell_start[c], one.order.begin() + one.cell_start[c + 1]));
  for (const InstructionLevel level : levels())
    for (const int threads : {1, 2, 3, 7}) {
      build_cell_grid(x, 0, points.size(), 0.5f, {threads, level}, other);
      EXPECT_TRUE(std::equal(one.order.begin(), one.order.end(), other.order.begin(), other.order.end()));
      EXPECT_TRUE(std::equal(one.cell_start.begin(), one.cell_start.end(), other.cell_start.begin(),
                             other.cell_start.end()));
    }
}

struct TableRow {
  std::array<int, 3> count;
  float spacing, radius;
  double average;
};

// Model, "Table 1's scenes, decoded".
TEST(neighbors, lattice_averages_are_those_of_table_1) {
  for (const TableRow& row :
       {TableRow{{10, 10, 36}, 40.0f / 36, 8, 755.32}, TableRow{{10, 10, 36}, 40.0f / 36, 5, 256.54},
        TableRow{{10, 10, 36}, 40.0f / 36, 3, 64.28}, TableRow{{22, 22, 22}, 1, 2.9f, 80.70},
        TableRow{{15, 15, 15}, 22.0f / 15, 2.9f, 23.56}}) {
    Points points;
    for (int z = 0; z < row.count[2]; ++z)
      for (int y = 0; y < row.count[1]; ++y)
        for (int x = 0; x < row.count[0]; ++x)
          points.push_back(row.spacing * Vec3(Eigen::Vector3i(x, y, z).cast<float>()));
    CellGrid grid;
    NeighborLists lists;
    build_cell_grid(column(points), 0, points.size(), row.radius, {2, best_instruction_level()}, grid);
    build_neighbor_lists(grid, row.radius, {2, best_instruction_level()}, lists);
    EXPECT_NEAR(lists.average(), row.average, 0.005);
  }
}

}  // namespace neighbors_test
}  // namespace mallow

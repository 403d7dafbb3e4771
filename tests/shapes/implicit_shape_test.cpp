#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "mallow/body.h"
#include "shapes/random_points.h"

namespace mallow {
namespace implicit_shape_test {

TEST(implicit_shape, names_are_known_and_others_refused) {
  for (const char* name : implicit_shape_names()) EXPECT_TRUE(implicit_shape(name).distance) << name;
  EXPECT_EQ(problem_of([] { implicit_shape("maoi"); }),
            "implicit: \"maoi\" is not a known shape: one of moai");
}

TEST(implicit_shape, sphere_values_are_checked) {
  EXPECT_EQ(problem_of([] { sphere_shape(Vec3::Zero(), -2.0f); }), "radius: -2 is not allowed: a number > 0");
  EXPECT_EQ(problem_of([] { sphere_shape({NAN, 0.0f, 0.0f}, 2.0f); }).substr(0, 7), "center:");
}

TEST(placement, puts_size_and_center_where_they_are_wanted) {
  const ImplicitShape moai = moai_shape();
  const Vec3 side = moai.bounds.max - moai.bounds.min;
  const Vec3 center{5.0f, 6.0f, 7.0f};
  const ImplicitShape placed = place(moai, {.rotate = Vec3::Zero(), .size = 10.0f, .center = center});
  const Vec3 placed_side = placed.bounds.max - placed.bounds.min;
  EXPECT_NEAR(placed_side.maxCoeff(), 10.0f, 1e-5f);
  EXPECT_LT((placed_side / 10.0f - side / side.maxCoeff()).norm(), 1e-6f);
  EXPECT_LT((0.5f * (placed.bounds.min + placed.bounds.max) - center).norm(), 1e-5f);
}

TEST(placement, turns_about_x_then_y_then_z) {
  const auto offset_ball = [](const Vec3& x) { return (x - Vec3(0.0f, 0.5f, 0.0f)).norm() - 0.1f; };
  const ImplicitShape ball{offset_ball, {Vec3::Constant(-1.0f), Vec3::Constant(1.0f)}};
  // +y turns to +z about x, and on to +x about y; the turn about z then takes it to +y.
  const auto at = [&](const Vec3& rotate, const Vec3& x) {
    return place(ball, {.rotate = rotate}).distance(x);
  };
  EXPECT_NEAR(at({90.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.5f}), -0.1f, 1e-6f);
  EXPECT_NEAR(at({90.0f, 90.0f, 0.0f}, {0.5f, 0.0f, 0.0f}), -0.1f, 1e-6f);
  EXPECT_NEAR(at({90.0f, 90.0f, 90.0f}, {0.0f, 0.5f, 0.0f}), -0.1f, 1e-6f);
}

TEST(placement, keeps_distances_and_what_is_left_out) {
  const ImplicitShape moai = moai_shape();
  const ImplicitShape same = place(moai, {});
  const ImplicitShape twice = place(moai, {.size = 2.0f * (moai.bounds.max - moai.bounds.min).maxCoeff()});
  const Vec3 middle = 0.5f * (moai.bounds.min + moai.bounds.max);
  for (const Vec3& x : random_points(200, moai.bounds.min, moai.bounds.max)) {
    EXPECT_NEAR(same.distance(x), moai.distance(x), 1e-5f);
    EXPECT_NEAR(twice.distance(middle + 2.0f * (x - middle)), 2.0f * moai.distance(x), 1e-4f);
  }
}

TEST(placement, turned_bounds_hold_the_shape) {
  const ImplicitShape turned = place(moai_shape(), {.rotate = {30.0f, 40.0f, 50.0f}});
  const ImplicitShape wider{
      turned.distance, {turned.bounds.min - Vec3::Constant(5.0f), turned.bounds.max + Vec3::Constant(5.0f)}};
  const Body body = sample(wider, {.spacing = 0.8f});
  for (const Vec3& x : body.positions) {
    EXPECT_TRUE((x.array() > turned.bounds.min.array()).all() &&
                (x.array() < turned.bounds.max.array()).all());
  }
}

TEST(placement, bad_values_are_named) {
  const ImplicitShape moai = moai_shape();
  EXPECT_EQ(problem_of([&] { place(moai, {.size = 0.0f}); }), "size: 0 is not allowed: a number > 0");
  EXPECT_EQ(problem_of([&] { place(moai, {.rotate = {0.0f, INFINITY, 0.0f}}); }).substr(0, 7), "rotate:");
  EXPECT_EQ(problem_of([&] { place(moai, {.center = Vec3(0.0f, 0.0f, NAN)}); }).substr(0, 7), "center:");
}

TEST(moai, is_closed_within_its_bounds) {
  const ImplicitShape moai = moai_shape();
  const Vec3 side = moai.bounds.max - moai.bounds.min;
  constexpr int cells = 120;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j <= cells; ++j)
        for (int end = 0; end < 2; ++end) {
          Vec3 share;
          share[axis] = float(end);
          share[(axis + 1) % 3] = float(i) / float(cells);
          share[(axis + 2) % 3] = float(j) / float(cells);
          const Vec3 x = moai.bounds.min + share.cwiseProduct(side);
          ASSERT_GT(moai.distance(x), 0.0f) << x.transpose();
        }
}

TEST(moai, stands_on_the_floor_40_high_and_symmetric) {
  const ImplicitShape moai = moai_shape();
  EXPECT_LT(moai.distance({-2.0f, 0.0f, 0.01f}), 0.0f);
  EXPECT_GT(moai.distance({-2.0f, 0.0f, -0.01f}), 0.0f);
  EXPECT_LT(moai.distance({-2.0f, 0.0f, 39.99f}), 0.0f);
  EXPECT_GT(moai.distance({-2.0f, 0.0f, 40.01f}), 0.0f);
  for (const Vec3& x : random_points(200, moai.bounds.min, moai.bounds.max)) {
    EXPECT_EQ(moai.distance(x), moai.distance({x.x(), -x.y(), x.z()}));
  }
}

TEST(moai, slope_of_the_distance_is_below_1_2) {
  const ImplicitShape moai = moai_shape();
  const std::vector<Vec3> points = random_points(20000, {-15.0f, -12.0f, -5.0f}, {18.0f, 12.0f, 45.0f});
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 near = points[i] + 0.01f * (points[i - 1] - points[i]);
    EXPECT_LE(std::abs(moai.distance(near) - moai.distance(points[i])),
              1.2f * (near - points[i]).norm() + 1e-5f);
  }
}

TEST(moai, is_one_piece_when_sampled) {
  const Body body = sample(moai_shape(), {.count = 3764});
  using Cell = std::array<int, 3>;
  std::set<Cell> left;
  for (const Vec3& x : body.positions) {
    const Vec3 cell = (x - body.positions[0]) / body.spacing;
    left.insert({int(std::lround(cell.x())), int(std::lround(cell.y())), int(std::lround(cell.z()))});
  }
  ASSERT_EQ(left.size(), body.positions.size());
  std::vector<Cell> open{*left.begin()};
  left.erase(left.begin());
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int step : {-1, 1}) {
        Cell next = cell;
        next[axis] += step;
        if (left.erase(next) > 0) open.push_back(next);
      }
  }
  EXPECT_TRUE(left.empty()) << left.size() << " points are not joined to the rest";
}

}  // namespace implicit_shape_test
}  // namespace mallow

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "mallow/body.h"
#include "shapes/random_points.h"

namespace mallow {
namespace sampling_test {

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();

TEST(lattice, points_are_in_the_middle_of_cells_with_x_fastest) {
  const Body body = sample(Lattice{{2, 3, 4}, 0.5f, {10.0f, 20.0f, 30.0f}, 0});
  ASSERT_EQ(body.positions.size(), 24u);
  EXPECT_EQ(body.spacing, 0.5f);
  EXPECT_EQ(body.positions[0], Vec3(10.25f, 20.25f, 30.25f));
  EXPECT_EQ(body.positions[1], Vec3(10.75f, 20.25f, 30.25f));
  EXPECT_EQ(body.positions[2], Vec3(10.25f, 20.75f, 30.25f));
  EXPECT_EQ(body.positions[6], Vec3(10.25f, 20.25f, 30.75f));
  EXPECT_EQ(body.positions[23], Vec3(10.75f, 21.25f, 31.75f));
}

TEST(lattice, bad_values_are_named) {
  EXPECT_EQ(problem_of([] {
              sample(Lattice{{2, 0, 2}, 1.0f, Vec3::Zero()});
            }),
            "count[1]: 0 is not allowed: a whole number in [1, 100000000]");
  EXPECT_EQ(problem_of([] {
              sample(Lattice{{2, 2, 2}, -1.0f, Vec3::Zero()});
            }),
            "spacing: -1 is not allowed: a number > 0");
  EXPECT_EQ(problem_of([] {
              sample(Lattice{{2, 2, 2}, k_nan, Vec3::Zero()});
            }),
            "spacing: nan is not allowed: a number > 0");
  EXPECT_EQ(problem_of([] {
              sample(Lattice{{2, 2, 2}, 1.0f, {0.0f, k_nan, 0.0f}});
            }).substr(0, 7),
            "corner:");
  EXPECT_EQ(problem_of([] { sample(Lattice{{2, 2, 2}, 3e38f, Vec3::Zero()}); }).substr(0, 8), "spacing:");
}

TEST(lattice, more_than_100_million_points_are_refused_before_allocation) {
  EXPECT_EQ(problem_of([] {
              sample(Lattice{{100'000'000, 100'000'000, 2}, 1.0f, Vec3::Zero()});
            }),
            "count: 2e+16 is not allowed: 100000000 points at most");
  EXPECT_EQ(problem_of([] {
              sample(Lattice{{2000000000, 1, 1}, 1.0f, Vec3::Zero()});
            }),
            "count[0]: 2000000000 is not allowed: a whole number in [1, 100000000]");
}

TEST(lattice, all_problems_are_said_at_once) {
  try {
    sample(Lattice{{0, 1, -3}, 0.0f, {k_nan, 0.0f, 0.0f}});
    FAIL() << "nothing thrown";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().size(), 4u);
  }
}

TEST(sampling, sphere_holds_its_volume_in_cells) {
  for (float spacing : {0.5f, 0.73f, 1.0f}) {
    const Body body = sample(sphere_shape({1.0f, 2.0f, 3.0f}, 10.0f), {.spacing = spacing});
    const double cells = 4.0 / 3.0 * std::numbers::pi * std::pow(10.0 / double(spacing), 3);
    EXPECT_NEAR(double(body.positions.size()) / cells, 1.0, 0.02);
    EXPECT_EQ(body.spacing, spacing);
  }
}

TEST(sampling, equals_a_test_of_every_lattice_point) {
  const ImplicitShape moai = moai_shape();
  constexpr float spacing = 1.1f;
  const Body body = sample(moai, {.spacing = spacing, .jitter = 0});
  std::size_t expected = 0;
  const Vec3 middle = 0.5f * (moai.bounds.min + moai.bounds.max);
  for (int z = -30; z < 30; ++z)
    for (int y = -30; y < 30; ++y)
      for (int x = -30; x < 30; ++x)
        expected +=
            moai.distance(middle + spacing * (Vec3(float(x), float(y), float(z)) + Vec3::Constant(0.5f))) < 0;
  EXPECT_EQ(body.positions.size(), expected);
  for (const Vec3& x : body.positions) {
    EXPECT_LT(moai.distance(x), 0.0f);
    const Vec3 cell = (x - middle) / spacing - Vec3::Constant(0.5f);
    EXPECT_LT((cell - cell.array().round().matrix()).norm(), 1e-4f);
  }
}

TEST(sampling, wanted_counts_are_met_within_1_percent) {
  const ImplicitShape sphere = sphere_shape({-3.0f, 0.5f, 8.0f}, 7.0f);
  const ImplicitShape moai = moai_shape();
  for (int wanted : {1328, 2015, 3764, 4185, 10648}) {
    EXPECT_NEAR(double(sample(sphere, {.count = wanted}).positions.size()), wanted, 0.01 * wanted);
    EXPECT_NEAR(double(sample(moai, {.count = wanted}).positions.size()), wanted, 1.0);
  }
}

TEST(sampling, spacing_for_a_wanted_count_fits_the_volume) {
  const Body body = sample(sphere_shape(Vec3::Zero(), 10.0f), {.count = 4185});
  EXPECT_NEAR(double(body.positions.size()) * std::pow(double(body.spacing), 3), 4188.8, 84.0);
}

TEST(sampling, single_points_and_tiny_counts_are_met) {
  EXPECT_EQ(sample(sphere_shape({1.0f, 2.0f, 3.0f}, 1.0f), {.count = 1, .jitter = 0}).positions.at(0),
            Vec3(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(sample(sphere_shape(Vec3::Zero(), 1.0f), {.count = 8}).positions.size(), 8u);
}

TEST(sampling, gives_the_same_points_each_time) {
  const Sampling sampling{.count = 1328, .jitter = 0.3f};
  EXPECT_EQ(sample(moai_shape(), sampling).positions, sample(moai_shape(), sampling).positions);
}

TEST(sampling, jitter_moves_points_by_its_share_and_keeps_them_inside) {
  const ImplicitShape sphere = sphere_shape({1.0f, -2.0f, 3.0f}, 6.0f);
  const Body regular = sample(sphere, {.spacing = 0.5f, .jitter = 0});
  const Body jittered = sample(sphere, {.spacing = 0.5f, .jitter = 0.4f});
  ASSERT_EQ(jittered.positions.size(), regular.positions.size());
  Vec3 largest = Vec3::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero();
  std::size_t deep = 0;
  for (std::size_t i = 0; i < regular.positions.size(); ++i) {
    EXPECT_LT(sphere.distance(jittered.positions[i]), 0.0f);
    const Vec3 moved = jittered.positions[i] - regular.positions[i];
    largest = largest.cwiseMax(moved.cwiseAbs());
    if (sphere.distance(regular.positions[i]) > -0.5f) continue;
    ++deep;
    mean += moved.cast<double>();
    square += moved.cast<double>().cwiseAbs2();
  }
  // A quarter of the sum of four that are uniform in ± 0.2: variance 0.2²/12.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(largest[axis], 0.2001f);
    EXPECT_GT(largest[axis], 0.16f);
    EXPECT_NEAR(mean[axis] / double(deep), 0.0, 0.01);
    EXPECT_NEAR(square[axis] / double(deep), 0.2 * 0.2 / 12.0, 2e-4);
  }
}

TEST(sampling, without_a_word_points_are_displaced_so_that_a_lattice_has_no_directions) {
  const Body box = sample(Lattice{.count = {9, 9, 9}});
  const Body lattice = sample(Lattice{.count = {9, 9, 9}, .jitter = 0});
  const Body ball = sample(sphere_shape(Vec3::Zero(), 5), {.spacing = 1});
  const Body regular = sample(sphere_shape(Vec3::Zero(), 5), {.spacing = 1, .jitter = 0});
  for (const auto& [moved, at_rest] : {std::pair{box, lattice}, std::pair{ball, regular}}) {
    ASSERT_EQ(moved.positions.size(), at_rest.positions.size());
    float most = 0;
    for (std::size_t i = 0; i < moved.positions.size(); ++i)
      most = std::max(most, (moved.positions[i] - at_rest.positions[i]).cwiseAbs().maxCoeff());
    EXPECT_GT(most, 0.15f);
    EXPECT_LE(most, 0.2001f);
  }
}

TEST(sampling, the_largest_jitter_keeps_points_a_tenth_of_the_spacing_apart) {
  const Body box = sample(Lattice{.count = {16, 16, 16}, .jitter = 0.45f});
  float nearest = 1;
  for (std::size_t i = 0; i < box.positions.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      nearest = std::min(nearest, (box.positions[i] - box.positions[j]).norm());
  EXPECT_GE(nearest, 0.1f);
}

TEST(sampling, where_floats_cannot_tell_neighbours_apart_is_refused) {
  EXPECT_EQ(sample(Lattice{.count = {2, 2, 2}, .spacing = 0.1f, .corner = {1e5f, 0, 0}}).positions.size(),
            8u);
  EXPECT_EQ(problem_of([] {
              sample(Lattice{.count = {2, 2, 2}, .spacing = 0.1f, .corner = {0, 4.5e6f, 0}});
            }).substr(0, 60),
            "corner: (0.2 4500000 0.2) is too far from 0 for a spacing of");
  EXPECT_EQ(problem_of([] {
              sample(sphere_shape({0, 0, -4.5e6f}, 1), {.spacing = 0.1f});
            }).substr(0, 9),
            "bounds: (");
  EXPECT_EQ(problem_of([] {
              sample(sphere_shape({0, 0, -4.5e6f}, 1), {.count = 4000});
            }).substr(0, 9),
            "bounds: (");
}

TEST(sampling, points_that_miss_the_volume_are_noted_with_a_spacing_that_does_better) {
  const Body coarse = sample(sphere_shape(Vec3::Zero(), 1), {.spacing = 1.1f});
  ASSERT_EQ(coarse.notes.size(), 1u);
  EXPECT_EQ(coarse.notes[0].substr(0, 82),
            "8 points with spacing 1.1 stand for a volume of 10.648, but the shape's is 4.18879");
  EXPECT_NE(coarse.notes[0].find("points, which fit its volume"), std::string::npos) << coarse.notes[0];
  EXPECT_TRUE(sample(sphere_shape(Vec3::Zero(), 1), {.spacing = 0.2f}).notes.empty());
}

TEST(sampling, bad_values_are_named) {
  const ImplicitShape sphere = sphere_shape(Vec3::Zero(), 1.0f);
  const auto problem = [&](const Sampling& sampling) {
    return problem_of([&] { sample(sphere, sampling); });
  };
  EXPECT_EQ(problem({.spacing = 0.0f}), "spacing: 0 is not allowed: a number > 0");
  EXPECT_EQ(problem({.spacing = k_nan}), "spacing: nan is not allowed: a number > 0");
  EXPECT_EQ(problem({.count = 0}), "count: 0 is not allowed: a whole number in [1, 100000000]");
  EXPECT_EQ(problem({.count = 100000001}).substr(0, 17), "count: 100000001 ");
  EXPECT_EQ(problem({.spacing = 0.1f, .jitter = 0.6f}).substr(0, 11), "jitter: 0.6");
  EXPECT_EQ(problem({}).substr(0, 9), "sampling:");
  EXPECT_EQ(problem({.spacing = 0.1f, .count = 5}).substr(0, 9), "sampling:");
  EXPECT_EQ(problem({.spacing = 1e-9f}).substr(0, 14), "spacing: 1e-09");
  EXPECT_EQ(problem({.spacing = 2.5f}).substr(0, 8), "spacing:");
  EXPECT_EQ(problem_of([&] { sample({sphere.distance, {}}, {.count = 5}); }).substr(0, 7), "bounds:");
}

TEST(sampling, too_many_points_are_counted_and_refused) {
  // 4/3 π 300³ points, of 600³ in the bounds.
  const std::string problem =
      problem_of([] { sample(sphere_shape(Vec3::Zero(), 1.0f), {.spacing = 1.0f / 300.0f}); });
  EXPECT_NE(problem.find(" and 113"), std::string::npos) << problem;
}

TEST(sampling, a_spacing_far_too_fine_names_the_width_of_the_shape_and_that_of_centimetres) {
  EXPECT_EQ(
      problem_of([] { sample(sphere_shape(Vec3::Zero(), 8.5f), {.spacing = 0.005f}); }),
      "spacing: 0.005 is not allowed: the shape is 17 m wide, 3400 spacings, and its bounds would hold more "
      "than 1e+09 lattice points; give a spacing that suits its width, or the width that it is meant to "
      "have, 0.17 where it is in centimetres");
}

TEST(sampling, a_count_that_symmetry_forbids_names_the_nearest) {
  // A cube holds n · n · n points, or one more along some of its sides: 216, 252, 294, 343, ...
  const ImplicitShape cube{[](const Vec3& x) { return x.cwiseAbs().maxCoeff() - 1.0f; },
                           {Vec3::Constant(-1.0f), Vec3::Constant(1.0f)}};
  EXPECT_EQ(sample(cube, {.count = 343}).positions.size(), 343u);
  EXPECT_EQ(sample(cube, {.count = 252}).positions.size(), 252u);
  EXPECT_EQ(problem_of([&] { sample(cube, {.count = 232}); }),
            "count: 232 cannot be met within 1%: the nearest number that fits is 216");
}

TEST(sampling, an_empty_shape_is_refused) {
  const ImplicitShape nothing{[](const Vec3&) { return 1.0f; },
                              {Vec3::Constant(-1.0f), Vec3::Constant(1.0f)}};
  EXPECT_EQ(problem_of([&] { sample(nothing, {.count = 1000}); }),
            "count: 1000 cannot be met: the shape fills too little of its bounds");
  EXPECT_EQ(problem_of([&] { sample(nothing, {.spacing = 0.1f}); }),
            "spacing: no lattice point lies inside the shape at 0.1: a smaller spacing");
}

}  // namespace sampling_test
}  // namespace mallow

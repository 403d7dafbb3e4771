#include <gtest/gtest.h>

#include <atomic>

#include <Eigen/SVD>
#include <numeric>
#include <random>

#include "core/bounds.h"
#include "core/checks.h"
#include "core/column.h"
#include "core/parallel.h"
#include "core/polar_rotation.h"

namespace mallow {
namespace core_test {

TEST(column, keeps_values_when_it_grows_and_pads_with_zeros) {
  Column<float> column(5);
  std::iota(column.begin(), column.end(), 1.0f);
  column.resize(40);
  EXPECT_EQ(column[4], 5.0f);
  column.resize(3);
  column.resize(6);
  EXPECT_EQ(column[2], 3.0f);
  for (std::size_t i = 3; i < padded(6); ++i) EXPECT_EQ(column.data()[i], 0.0f);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(column.data()) % 64, 0u);
}

TEST(column, that_grows_again_and_again_is_rarely_allocated_anew) {
  Column<float> column(1000);
  VectorColumn vectors(1000);
  column[4] = 7;
  vectors.set(4, {7, 8, 9});
  EXPECT_EQ(column.bytes(), padded(1000) * sizeof(float)) << "what is made at once has no room to spare";
  int moved = 0;
  for (std::size_t size = 1001; size <= 10000; ++size) {
    const float *const memory = column.data(), *const of_vectors = vectors.x();
    column.resize(size);
    vectors.resize(size);
    moved += column.data() != memory;
    moved += vectors.x() != of_vectors;
    ASSERT_EQ(column[size - 1], 0.0f);
    ASSERT_EQ(vectors.get(size - 1), Vec3(0, 0, 0));
  }
  EXPECT_LE(moved, 2 * 11) << "1.25^11 is above 10";
  EXPECT_EQ(column[4], 7.0f);
  EXPECT_EQ(vectors.get(4), Vec3(7, 8, 9));
}

TEST(column, opens_and_closes_gaps_and_keeps_its_padding_zero) {
  Column<std::uint16_t> column(20);
  VectorColumn vectors(20);
  for (std::size_t i = 0; i < 20; ++i) {
    column[i] = static_cast<std::uint16_t>(i);
    vectors.set(i, Vec3::Constant(static_cast<float>(i)));
  }
  column.insert(5, 3);
  vectors.insert(5, 3);
  const std::vector<std::uint32_t> places{0, 6, 7, 22};
  column.erase(places);
  vectors.erase(places);
  const std::vector<std::uint16_t> expected{1, 2, 3, 4, 0, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18};
  ASSERT_EQ(column.size(), expected.size());
  ASSERT_EQ(vectors.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(column[i], expected[i]);
    EXPECT_EQ(vectors.get(i), Vec3::Constant(expected[i]));
  }
  for (std::size_t i = expected.size(); i < padded(expected.size()); ++i) {
    EXPECT_EQ(column.data()[i], 0);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(vectors.axis(axis)[i], 0.0f);
  }
}

TEST(column, has_zeros_in_the_cache_line_behind_its_last_block) {
  Column<float> shrunk(64), unset(64);
  VectorColumn vectors(64);
  for (Column<float>* column : {&shrunk, &unset}) std::fill(column->begin(), column->end(), 1.0f);
  for (std::size_t i = 0; i < 64; ++i) vectors.set(i, Vec3::Ones());
  shrunk.resize(20);
  unset.resize_unset(20);
  vectors.resize(20);
  for (std::size_t i = 20; i < padded(20) + k_lanes; ++i) {
    EXPECT_EQ(shrunk.data()[i], 0.0f) << i;
    EXPECT_EQ(unset.data()[i], 0.0f) << i;
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(vectors.axis(axis)[i], 0.0f) << i;
  }
}

TEST(column, memory_that_is_kept_outlives_it_and_is_not_handed_out_again) {
  std::shared_ptr<const void> first, second;
  const float* seen = nullptr;
  {
    Column<float> column(1000);
    column[999] = 7;
    seen = column.data();
    first = keep_column(seen);
    second = keep_column(seen);
    column.resize(5000);
    EXPECT_NE(column.data(), seen);
    EXPECT_EQ(column[999], 7.0f);
  }
  first.reset();
  for (int i = 0; i < 20; ++i) EXPECT_NE(Column<float>(1000).data(), seen);
  EXPECT_EQ(seen[999], 7.0f);
}

TEST(vector_column, keeps_all_three_axes_when_the_stride_changes) {
  VectorColumn column(3);
  for (std::size_t i = 0; i < 3; ++i) column.set(i, Vec3(1, 2, 3) * static_cast<float>(i + 1));
  column.resize(100);
  EXPECT_EQ(column.get(2), Vec3(3, 6, 9));
  EXPECT_EQ(column.get(99), Vec3(0, 0, 0));
}

TEST(parallel_for, calls_for_every_index_once_also_with_more_threads_than_blocks_or_ranges) {
  for (const int threads : {1, 2, 3, 7, 70})
    for (const std::size_t n : {0u, 1u, 255u, 256u, 5000u, 40000u}) {
      std::vector<std::atomic<int>> calls(n);
      parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
        EXPECT_EQ(begin % k_block, 0u);
        EXPECT_LE(end - begin, k_block);
        for (std::size_t i = begin; i < end; ++i) ++calls[i];
      });
      for (const auto& count : calls) ASSERT_EQ(count, 1) << threads << " threads, " << n;
    }
}

TEST(bounds, hold_every_point_and_touch_some_on_each_side) {
  VectorColumn x(1000);
  for (std::size_t i = 0; i < x.size(); ++i)
    x.set(i, {static_cast<float>(i % 7), -static_cast<float>(i % 11), static_cast<float>(i)});
  std::vector<Aabb> partial;
  for (const int threads : {1, 3}) {
    const Aabb box = bounds_of(x, 20, 990, threads, partial);
    EXPECT_EQ(box.min, Vec3(0, -10, 20));
    EXPECT_EQ(box.max, Vec3(6, 0, 989));
  }
}

TEST(parallel_reduce, gives_the_same_bits_for_any_number_of_threads) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<float> values(100003);
  for (float& v : values) v = normal(random);
  std::vector<float> partial;
  const auto sum = [&](int threads) {
    return parallel_reduce(
        threads, values.size(), partial, 0.0f,
        [&](std::size_t b, std::size_t e) {
          float s = 0;
          for (std::size_t i = b; i < e; ++i) s += values[i];
          return s;
        },
        [](float a, float b) { return a + b; });
  };
  const float one = sum(1);
  for (const int threads : {2, 3, 4, 8}) EXPECT_EQ(sum(threads), one);
}

Eigen::Matrix3d svd_rotation(const Eigen::Matrix3d& a) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

TEST(polar_rotation, is_the_polar_factor_and_never_a_reflection) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 2000; ++trial) {
    Eigen::Matrix3d a;
    for (int k = 0; k < 9; ++k) a(k) = normal(random);
    const Eigen::Matrix3d expected = svd_rotation(a);
    const Eigen::Matrix3d r =
        polar_rotation(a, Eigen::Quaterniond::UnitRandom(), a.norm()).toRotationMatrix();
    EXPECT_NEAR(r.determinant(), 1.0, 1e-12);
    const Eigen::Vector3d s = a.jacobiSvd().singularValues();
    // A mirrored matrix whose smaller singular values are nearly equal has no single answer.
    const double gap = s[1] + (a.determinant() < 0 ? -s[2] : s[2]);
    if (gap < 1e-3 * a.norm()) continue;
    EXPECT_LT((r - expected).norm(), 1e-12 * s[0] / gap);
  }
}

TEST(polar_rotation, keeps_the_last_rotation_where_the_matrix_says_nothing) {
  const Eigen::Quaterniond last(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  EXPECT_LT(polar_rotation(Eigen::Matrix3d::Zero(), last, 1.0).angularDistance(last), 1e-12);
  EXPECT_LT(polar_rotation(Eigen::Matrix3d::Zero(), last, 0.0).angularDistance(last), 1e-12);
  // A line that turned: the rotation takes its direction along and does not spin about it.
  const Eigen::Vector3d from = last * Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.4, from.cross(Eigen::Vector3d::UnitZ()).normalized()));
  const Eigen::Matrix3d line = (turn * from) * Eigen::Vector3d::UnitX().transpose();
  EXPECT_LT(polar_rotation(line, last, 1.0).angularDistance(turn * last), 1e-9);
}

TEST(polar_rotation, survives_matrices_that_are_not_finite) {
  const Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d a = Eigen::Matrix3d::Identity();
  a(1, 1) = std::nan("");
  EXPECT_EQ(polar_rotation(a, last, 1.0).coeffs(), last.coeffs());
}

TEST(problem, is_written_as_file_line_column_field_message) {
  EXPECT_EQ(to_string(Problem{"a.toml", 3, 7, "solver.time_step", "-1 is not allowed"}),
            "a.toml:3:7: solver.time_step: -1 is not allowed");
  EXPECT_EQ(to_string(Problem{.field = "x", .message = "bad"}), "x: bad");
  EXPECT_EQ(to_string(Problem{.line = 2, .message = "bad"}), "2: bad");
}

TEST(checks, say_every_problem_at_once) {
  Checks checks;
  checks.number("a", -1.0f, false, "above 0");
  checks.number("b", std::nanf(""), true, "a finite number");
  checks.number("c", 1.0f, true, "above 0");
  try {
    checks.finish();
    FAIL();
  } catch (const ConfigError& error) {
    ASSERT_EQ(error.problems().size(), 2u);
    EXPECT_EQ(error.problems()[0].message, "-1 is not allowed: above 0");
    EXPECT_EQ(error.problems()[1].field, "b");
  }
}

}  // namespace core_test
}  // namespace mallow

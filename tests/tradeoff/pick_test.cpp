#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "mallow/errors.h"
#include "mallow/tuning.h"

namespace mallow::pick_test {

const std::vector<Trade> k_trades = {{4, 0.1}, {1, 0.8}, {2, 0.3}, {3, 0.5}, {2, 0.4}, {9, std::nan("")}};

TEST(tradeoff_pick, front_leaves_out_what_another_beats_at_no_more_cost) {
  EXPECT_EQ(pareto_front(k_trades), (std::vector<std::size_t>{1, 2, 0}));
}

TEST(tradeoff_pick, by_error_is_the_cheapest_that_holds) {
  const auto pick = pick_by_error(k_trades, 0.45);
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->index, 2u);
  EXPECT_TRUE(pick->holds);
}

TEST(tradeoff_pick, by_cost_is_the_most_accurate_that_holds) {
  const auto pick = pick_by_cost(k_trades, 3.5);
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->index, 2u);
  EXPECT_TRUE(pick->holds);
}

TEST(tradeoff_pick, is_the_nearest_where_nothing_holds) {
  const auto accurate = pick_by_error(k_trades, 0.01), fast = pick_by_cost(k_trades, 0.5);
  ASSERT_TRUE(accurate && fast);
  EXPECT_EQ(accurate->index, 0u);
  EXPECT_FALSE(accurate->holds);
  EXPECT_EQ(fast->index, 1u);
  EXPECT_FALSE(fast->holds);
}

TEST(tradeoff_pick, is_none_where_no_number_is_finite) {
  const std::vector<Trade> none = {{std::nan(""), 1}, {1, std::nan("")}};
  EXPECT_FALSE(pick_by_error(none, 1));
  EXPECT_FALSE(pick_by_cost({}, 1));
  EXPECT_TRUE(pareto_front(none).empty());
}

TEST(tradeoff_pick, order_of_halved_differences_is_the_power_of_two_between_them) {
  EXPECT_DOUBLE_EQ(*convergence_order(std::vector<double>{0.9, 0.4, 0.1}), 2);
  EXPECT_FALSE(convergence_order(std::vector<double>{0.4}));
  EXPECT_FALSE(convergence_order(std::vector<double>{0.4, 0}));
}

TEST(tradeoff_pick, errors_are_distances_by_id_in_spacings) {
  const auto at = [](std::vector<Vec3> positions, std::vector<ParticleId> ids) {
    Motion motion;
    motion.spacings = {0.5f};
    motion.moments.push_back({.particles = {.positions = positions,
                                            .velocities = {},
                                            .bodies = std::vector<std::uint32_t>(positions.size(), 0),
                                            .ids = std::move(ids)}});
    return motion;
  };
  const Motion reference = at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {0, 2, 5});
  const MotionError error = motion_error(at({{0, 0, 0}, {9, 9, 9}, {2, 0, 1}}, {0, 3, 5}), reference);
  EXPECT_EQ(error.unmatched, 2u);
  EXPECT_DOUBLE_EQ(error.worst, 2);
  EXPECT_DOUBLE_EQ(error.rms, std::sqrt(2.0));
  EXPECT_THROW(motion_error(reference, reference, 1), ConfigError);
}

/// A cube of n^3 particles of 1 m, at the begin and after a stretch along x by a fifth.
Motion stretched_cube(int n, float more = 0) {
  Motion motion;
  const float h = 1 / static_cast<float>(n);
  motion.spacings = {h};
  for (const float stretch : {0.0f, 0.2f}) {
    ParticleFrame frame;
    for (int i = 0; i < n * n * n; ++i) {
      const Vec3 cell{static_cast<float>(i % n), static_cast<float>(i / n % n),
                      static_cast<float>(i / n / n)};
      Vec3 x = h * (cell + Vec3::Constant(0.5f));
      x.x() *= 1 + stretch;
      if (stretch > 0) x.z() += more;
      frame.positions.push_back(x);
      frame.bodies.push_back(0);
    }
    motion.moments.push_back({.particles = std::move(frame)});
  }
  return motion;
}

TEST(tradeoff_pick, another_sampling_is_compared_by_what_its_neighbours_of_the_begin_have_moved) {
  const Motion reference = stretched_cube(20), coarse = stretched_cube(15);
  EXPECT_LT(motion_error(coarse, reference).rms, 0.05) << "the same motion: what weights leave of it";
  const MotionError shifted = motion_error(stretched_cube(15, 0.15f), reference, 0.5);
  EXPECT_NEAR(shifted.median, 3, 0.02) << "0.15 m in spacings of the reference";
}

TEST(tradeoff_pick, another_sampling_takes_time_as_its_particles_not_as_pairs_of_them) {
  const Motion reference = stretched_cube(50), coarse = stretched_cube(40);
  const std::clock_t start = std::clock();
  motion_error(coarse, reference);
  // All pairs, 8 thousand millions of them, take half a minute.
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 3);
}

TEST(tradeoff_pick, plans_out_of_range_are_refused_by_name) {
  try {
    record_motion({}, {.frames = 3, .frame_time = 0});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().front().field, "frame_time");
  }
}

}  // namespace mallow::pick_test

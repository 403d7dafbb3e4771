#include <gtest/gtest.h>

#include <cmath>
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

TEST(tradeoff_pick, plans_out_of_range_are_refused_by_name) {
  try {
    record_motion({}, {.frames = 3, .frame_time = 0});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().front().field, "frame_time");
  }
}

}  // namespace mallow::pick_test

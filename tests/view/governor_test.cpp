#include <gtest/gtest.h>

#include <ctime>

#include "program/machine.h"
#include "view/frame_governor.h"
#include "view/pace.h"
#include "view/thread_governor.h"

namespace mallow {
namespace view_governor_test {

using namespace view;

/// Frames that take what a rung costs, until nothing changes any more.
int settled(FrameGovernor& governor, double as_written, double share_of_a_rung) {
  for (int frame = 0; frame < 1000; ++frame) {
    double seconds = as_written;
    for (int rung = k_as_written; rung < governor.rung(); ++rung) seconds *= share_of_a_rung;
    governor.add_frame(seconds);
  }
  return governor.rung();
}

TEST(view_governor, gives_up_as_much_as_a_rate_takes_and_no_more) {
  FrameGovernor governor;
  governor.set_target(30);
  EXPECT_EQ(settled(governor, 1.0 / 40, 0.8), k_as_written);
  EXPECT_EQ(settled(governor, 1.0 / 28, 0.8), k_as_written + 1);
  EXPECT_EQ(settled(governor, 1.0 / 20, 0.8), k_as_written + 2);
  EXPECT_EQ(settled(governor, 1, 0.8), static_cast<int>(rungs().size()) - 1) << "there is no more to give up";
}

TEST(view_governor, takes_back_what_it_gave_up_where_there_is_room) {
  FrameGovernor governor;
  governor.set_target(30);
  EXPECT_GT(settled(governor, 1.0 / 15, 0.8), k_as_written);
  EXPECT_EQ(settled(governor, 1.0 / 100, 0.8), k_as_written);
}

TEST(view_threads, are_as_many_as_processors_that_others_leave_and_one_at_the_least) {
  ThreadGovernor governor(7);
  const auto after = [&](double free) {
    for (int look = 0; look < 10; ++look) governor.add_look(free);
    return governor.threads();
  };
  EXPECT_EQ(governor.threads(), 7);
  EXPECT_EQ(after(7.9), 7);
  EXPECT_EQ(after(4.7), 5);
  EXPECT_EQ(after(0.1), 1);
  EXPECT_EQ(after(-2), 1);
  EXPECT_EQ(after(16), 7) << "what it was given at the most";
}

TEST(view_threads, stay_where_others_are_busy_for_a_moment) {
  ThreadGovernor governor(2);
  for (int look = 0; look < 20; ++look) EXPECT_FALSE(governor.add_look(look % 2 == 0 ? 0 : 2));
  EXPECT_FALSE(governor.add_look(0));
  EXPECT_TRUE(governor.add_look(0));
  for (int look = 0; look < 3; ++look) EXPECT_FALSE(governor.add_look(2)) << "no rise at once";
  EXPECT_TRUE(governor.add_look(2));
}

TEST(view_threads, processors_that_others_leave_are_no_more_than_there_are) {
  ProcessorLoad load;
  const double end = static_cast<double>(std::clock()) / CLOCKS_PER_SEC + 0.05;
  while (static_cast<double>(std::clock()) / CLOCKS_PER_SEC < end) {
  }
  const double free = load.look();
  EXPECT_LE(free, program::own_processors());
}

TEST(view_governor, does_nothing_without_a_target) {
  FrameGovernor governor;
  EXPECT_EQ(settled(governor, 10, 0.8), k_as_written);
}

TEST(view_governor, gives_up_steps_then_regions_then_voxels) {
  for (std::size_t k = 1; k < rungs().size(); ++k) {
    const Rung& before = rungs()[k - 1];
    const Rung& rung = rungs()[k];
    EXPECT_TRUE(rung.time_step >= before.time_step && rung.region_stride >= before.region_stride &&
                rung.voxels <= before.voxels);
    if (k <= static_cast<std::size_t>(k_as_written)) continue;
    if (rung.region_stride > 1) {
      EXPECT_EQ(rung.time_step, rungs().back().time_step);
    }
    if (rung.voxels < 1) {
      EXPECT_EQ(rung.region_stride, rungs().back().region_stride);
    }
  }
  EXPECT_EQ(describe(rungs()[k_as_written]), "");
  EXPECT_EQ(describe(rungs().back()),
            "steps 1.5 times as long, one region for 3 times the particles, voxels 2 times as wide");
}

TEST(view_pace, simulated_time_follows_the_walls_at_its_rate) {
  Pace pace;
  pace.set_rate(2);
  double time = 0;
  for (int tick = 0; tick <= 100; ++tick) {
    pace.add_wall(0.01 * tick, time, 0.5);
    while (pace.allows(time)) time += 0.02;
  }
  EXPECT_NEAR(time, 2, 0.021);
}

TEST(view_pace, what_falls_behind_is_not_caught_up_with) {
  Pace pace;
  pace.restart(0);
  pace.add_wall(0, 0, 0.1);
  pace.add_wall(100, 0, 0.1);
  EXPECT_TRUE(pace.allows(0.09));
  EXPECT_FALSE(pace.allows(0.11));
}

}  // namespace view_governor_test
}  // namespace mallow

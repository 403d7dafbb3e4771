#include <gtest/gtest.h>

#include <string>

#include "view/rewind_ring.h"

namespace mallow {
namespace view_rewind_test {

using namespace view;

Moment moment(int step, std::size_t bytes) {
  Moment result;
  result.time = 0.5 * step;
  result.step = step;
  result.state.chunks.push_back({"x", std::string(bytes, 'x')});
  return result;
}

TEST(view_rewind, finds_the_newest_state_before_a_time) {
  RewindRing ring(1 << 20);
  for (int step = 0; step < 10; ++step) ring.add(moment(step, 10));
  EXPECT_EQ(ring[ring.find(2.0)].step, 4);
  EXPECT_EQ(ring[ring.find(2.4)].step, 4);
  EXPECT_EQ(ring[ring.find(-1)].step, 0);
  EXPECT_EQ(ring[ring.find(100)].step, 9);
}

TEST(view_rewind, another_way_forgets_what_was_later) {
  RewindRing ring(1 << 20);
  for (int step = 0; step < 10; ++step) ring.add(moment(step, 10));
  ring.add(moment(4, 10));
  EXPECT_EQ(ring.size(), 5u);
  EXPECT_EQ(ring.bytes(), 5 * 11u);
}

TEST(view_rewind, stays_within_its_memory_and_keeps_the_beginning_and_the_newest) {
  RewindRing ring(10'000);
  for (int step = 0; step < 1000; ++step) {
    ring.add(moment(step, 500));
    ASSERT_LE(ring.bytes(), 10'000u);
    ASSERT_EQ(ring[0].step, 0);
    ASSERT_EQ(ring[ring.size() - 1].step, step);
  }
  EXPECT_GT(ring.size(), 8u);
  EXPECT_EQ(ring[ring.size() - 2].step, 998) << "it is dense near the present";
}

}  // namespace view_rewind_test
}  // namespace mallow

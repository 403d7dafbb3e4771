#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "view/command_queue.h"
#include "view/triple_buffer.h"

namespace mallow {
namespace view_hand_over_test {

using view::CommandQueue;
using view::TripleBuffer;

TEST(view_triple_buffer, the_reader_gets_the_newest_value_and_each_once) {
  TripleBuffer<int> buffer;
  EXPECT_FALSE(buffer.take());
  for (const int value : {1, 2, 3}) {
    buffer.back() = value;
    buffer.publish();
  }
  EXPECT_FALSE(buffer.is_taken());
  ASSERT_TRUE(buffer.take());
  EXPECT_EQ(buffer.front(), 3);
  EXPECT_TRUE(buffer.is_taken());
  EXPECT_FALSE(buffer.take());
  EXPECT_EQ(buffer.front(), 3) << "it keeps what it has";
}

TEST(view_triple_buffer, no_value_is_seen_while_it_is_written) {
  TripleBuffer<std::array<int, 256>> buffer;
  constexpr int k_last = 100'000;
  std::thread writer([&] {
    for (int k = 1; k <= k_last; ++k) {
      buffer.back().fill(k);
      buffer.publish();
    }
  });
  int last = 0;
  bool whole = true, rises = true;
  while (last < k_last) {
    if (!buffer.take()) continue;
    const auto& seen = buffer.front();
    for (const int value : seen) whole = whole && value == seen[0];
    rises = rises && seen[0] > last;
    last = seen[0];
  }
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(rises);
}

TEST(view_command_queue, all_commands_come_in_order) {
  CommandQueue<int> queue;
  constexpr int k_count = 10'000;
  std::thread sender([&] {
    for (int k = 0; k < k_count; ++k) queue.add(k);
  });
  int next = 0;
  bool in_order = true;
  while (next < k_count) {
    queue.wait_for(std::chrono::milliseconds(10));
    for (const int command : queue.take()) in_order = in_order && command == next++;
  }
  sender.join();
  EXPECT_TRUE(in_order);
}

}  // namespace view_hand_over_test
}  // namespace mallow

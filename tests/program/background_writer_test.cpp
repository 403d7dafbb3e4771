#include "program/background_writer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

namespace mallow::program {
namespace background_writer_test {

TEST(background_writer, does_all_jobs_in_order) {
  std::vector<int> done;
  BackgroundWriter writer;
  for (int k = 0; k < 100; ++k) writer.add([&done, k] { done.push_back(k); });
  writer.finish();
  ASSERT_EQ(done.size(), 100u);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(done[static_cast<std::size_t>(k)], k);
  writer.add([&done] { done.push_back(100); });
  writer.finish();
  EXPECT_EQ(done.size(), 101u);
}

TEST(background_writer, finishes_what_waits_when_it_goes) {
  std::atomic<int> done = 0;
  {
    BackgroundWriter writer;
    for (int k = 0; k < 10; ++k) {
      writer.add([&done] {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        ++done;
      });
    }
  }
  EXPECT_EQ(done, 10);
}

TEST(background_writer, holds_no_more_than_two_jobs) {
  std::atomic<bool> open = false;
  std::atomic<int> taken = 0;
  BackgroundWriter writer;
  std::thread producer([&] {
    for (int k = 0; k < 5; ++k) {
      writer.add([&open] {
        while (!open) std::this_thread::yield();
      });
      ++taken;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_LE(taken, 2);
  open = true;
  producer.join();
  writer.finish();
  EXPECT_EQ(taken, 5);
}

TEST(background_writer, what_a_job_throws_reaches_finish_and_add_and_ends_the_work) {
  std::atomic<int> done = 0;
  BackgroundWriter writer;
  writer.add([] { throw std::runtime_error("the disk is full"); });
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(message([&] { writer.finish(); }), "the disk is full");
  EXPECT_EQ(message([&] { writer.add([&done] { ++done; }); }), "the disk is full");
  EXPECT_EQ(message([&] { writer.finish(); }), "the disk is full");
  EXPECT_EQ(done, 0);
}

}  // namespace background_writer_test
}  // namespace mallow::program

#include "mallow/executor.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/governor.h"
#include "core/parallel.h"
#include "core/team.h"

#ifdef __unix__
#include <sys/wait.h>
#include <unistd.h>
#endif

#if defined(__SANITIZE_THREAD__)
#define MALLOW_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define MALLOW_THREAD_SANITIZER
#endif
#endif

namespace mallow {
namespace executor_test {

using namespace std::chrono_literals;

/// An application's: `how` decides who comes.
class Custom final : public Executor {
 public:
  explicit Custom(std::function<void(int, LoopTask)> how) : how_(std::move(how)) {}
  int concurrency() const override { return 3; }
  void run(int threads, LoopTask task) override { how_(threads, task); }

 private:
  std::function<void(int, LoopTask)> how_;
};

/// One loop over n; how often each index was visited is 1 everywhere.
testing::AssertionResult visits_each_once(const Threads& threads, std::size_t n,
                                          std::size_t block = k_block) {
  std::vector<std::atomic<int>> visits(n);
  parallel_for(
      threads, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) visits[i].fetch_add(1, std::memory_order_relaxed);
      },
      block);
  for (std::size_t i = 0; i < n; ++i)
    if (visits[i] != 1)
      return testing::AssertionFailure() << i << " of " << n << ": " << visits[i] << " visits";
  return testing::AssertionSuccess();
}

TEST(executor, every_block_runs_once_whoever_comes_and_when) {
  const auto nobody = std::make_shared<Custom>([](int, LoopTask) {});
  const auto caller = std::make_shared<Custom>([](int, LoopTask task) { task(0); });
  const auto late = std::make_shared<Custom>([](int, LoopTask task) {
    task(0);
    std::thread([=] { task(1); }).join();
  });
  const auto others_only = std::make_shared<Custom>([](int threads, LoopTask task) {
    std::vector<std::thread> others;
    for (int k = 1; k < threads; ++k) others.emplace_back([=] { task(static_cast<std::size_t>(k)); });
    for (std::thread& other : others) other.join();
  });
  const auto anywhere = std::make_shared<Custom>([](int, LoopTask task) { task(1'000'003); });
  for (const auto& executor : {nobody, caller, late, others_only, anywhere})
    for (const std::size_t n : {257u, 5000u, 40000u}) EXPECT_TRUE(visits_each_once(Threads(0, executor), n));
  EXPECT_EQ(Threads(0, caller).count(), 3);
  EXPECT_EQ(Threads(7, caller).count(), 7);
}

class shipped_executor : public testing::TestWithParam<std::shared_ptr<Executor> (*)()> {
 protected:
  const std::shared_ptr<Executor> executor_ = GetParam()();
  /// OpenMP waits for every thread in every loop: on a busy machine that takes a while.
  const std::size_t loops_ = GetParam() == openmp_executor ? 20 : 300;
};
/// A team with more threads than there are processors.
class CrowdedTeam final : public Executor {
 public:
  int concurrency() const override { return 8; }
  void run(int threads, LoopTask task) override {
    static std::mutex one_caller_at_a_time;
    const std::lock_guard lock(one_caller_at_a_time);
    team_.run(std::max(threads, 8), task);
  }

 private:
  Team team_;
};

std::shared_ptr<Executor> crowded_team() {
  return std::make_shared<CrowdedTeam>();
}

INSTANTIATE_TEST_SUITE_P(, shipped_executor, testing::Values(team_executor, openmp_executor, crowded_team),
                         [](const auto& test) {
                           return test.index == 0 ? "team" : test.index == 1 ? "openmp" : "crowded_team";
                         });

TEST_P(shipped_executor, every_block_runs_once_loop_after_loop) {
  for (const int threads : {2, 3, 8})
    for (std::size_t loop = 0; loop < loops_; ++loop) {
      // Now and then long enough for threads to fall asleep, or to be about to.
      if (loop % 10 == 0) std::this_thread::sleep_for(1us * (loop % 100));
      ASSERT_TRUE(visits_each_once(Threads(threads, executor_), 1 + 97 * loop % 3001, 64));
    }
}

TEST_P(shipped_executor, callers_on_several_threads_do_not_disturb_each_other) {
  std::vector<std::thread> callers;
  for (int k = 0; k < 4; ++k)
    callers.emplace_back([&] {
      for (std::size_t loop = 0; loop < loops_ / 3; ++loop)
        ASSERT_TRUE(visits_each_once(Threads(3, executor_), 100 + 31 * loop, 16));
    });
  for (std::thread& caller : callers) caller.join();
}

TEST_P(shipped_executor, a_loop_in_a_loop_runs_on_its_thread) {
  const Threads threads(3, executor_);
  std::vector<std::atomic<int>> visits(64 * 64);
  parallel_for(
      threads, 64,
      [&](std::size_t outer, std::size_t) {
        const std::thread::id here = std::this_thread::get_id();
        parallel_for(
            threads, 64,
            [&](std::size_t inner, std::size_t) {
              EXPECT_EQ(std::this_thread::get_id(), here);
              ++visits[64 * outer + inner];
            },
            1);
      },
      1);
  for (const auto& count : visits) ASSERT_EQ(count, 1);
}

TEST(team, ends_whether_its_threads_spin_or_sleep_or_never_began) {
  { const Team never_used; }
  for (const auto pause : {0us, 20us, 55us, 2000us}) {
    Team team;
    std::atomic<int> calls = 0;
    const LoopTask task([](void* count, std::size_t) noexcept { ++*static_cast<std::atomic<int>*>(count); },
                        &calls);
    team.run(4, task);
    EXPECT_GE(calls, 1);
    EXPECT_LE(calls, 4);
    std::this_thread::sleep_for(pause);
  }
}

TEST(team, threads_help_when_they_wake) {
  Team team;
  struct Loop {
    std::atomic<bool> caller_may_go = false;
    static void call(void* of, std::size_t place) noexcept {
      Loop& loop = *static_cast<Loop*>(of);
      if (place != 0) loop.caller_may_go = true;
      while (!loop.caller_may_go) std::this_thread::yield();
    }
  };
  for (int k = 0; k < 20; ++k) {
    Loop loop;
    team.run(2, LoopTask(Loop::call, &loop));
    std::this_thread::sleep_for(200us);
  }
}

#if defined(__unix__) && !defined(MALLOW_THREAD_SANITIZER)
TEST(team, a_process_that_was_forked_off_has_threads_of_its_own) {
  const Threads threads(2);
  if (team_executor()->concurrency() < 2) GTEST_SKIP() << "SKIPPED: there is one processor";
  ASSERT_TRUE(visits_each_once(threads, 5000));
  const pid_t child = fork();
  if (child == 0) {
    std::atomic<bool> helped = false;
    const std::thread::id caller = std::this_thread::get_id();
    for (int k = 0; k < 10'000 && !helped; ++k)
      parallel_for(
          threads, 2,
          [&](std::size_t, std::size_t) {
            if (std::this_thread::get_id() != caller) helped = true;
            std::this_thread::sleep_for(1ms);
          },
          1);
    std::exit(helped ? 0 : 1);  // also: the end of a program ends its teams
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}
#endif

TEST(governor, pauses_longer_after_each_long_wait_and_forgets_them_after_good_loops) {
  Governor governor(2);
  Governor::Clock::time_point now{1h};
  EXPECT_TRUE(governor.allows(now));
  for (const int pause : {8, 16, 32, 64, 64}) {
    governor.ended(1us, 3ms, now);
    EXPECT_FALSE(governor.allows(now));
    EXPECT_FALSE(governor.allows(now + pause * 3ms - 1us));
    now += pause * 3ms;
    EXPECT_TRUE(governor.allows(now));
  }
  for (int k = 1; k < Governor::k_good; ++k) governor.ended(1us, 0us, now);
  governor.ended(1us, 1ms, now);
  EXPECT_FALSE(governor.allows(now + 63ms));
  for (int k = 0; k < Governor::k_good; ++k) governor.ended(1us, 0us, now);
  governor.ended(1us, 1ms, now);
  EXPECT_FALSE(governor.allows(now + 7ms));
  EXPECT_TRUE(governor.allows(now + 8ms));
}

TEST(governor, tolerates_short_waits_and_those_of_uneven_blocks) {
  Governor governor(2);
  const Governor::Clock::time_point now{1h};
  governor.ended(1us, 50us, now);
  governor.ended(1ms, 2ms, now);
  EXPECT_TRUE(governor.allows(now));
  governor.ended(1ms, 3ms, now);
  EXPECT_FALSE(governor.allows(now));
}

}  // namespace executor_test
}  // namespace mallow

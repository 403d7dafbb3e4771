#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/governor.h"
#include "mallow/executor.h"

namespace mallow {

/// Threads that help one caller with its loops. A worker may join a loop while that is open; the caller works
/// until no block is left, closes it, and waits only for those that are inside. So a worker that the system
/// does not let run costs nothing: it comes late and finds the loop closed.
class Team {
 public:
  Team();
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// As Executor::run, for one caller at a time. Starts the threads that are missing; where the system gives
  /// no more, there are fewer.
  void run(int threads, LoopTask task) noexcept;

 private:
  struct Worker;

  std::size_t make_workers(std::size_t count) noexcept;
  void wake(std::size_t helpers);
  void wait_for_those_inside();
  void work(Worker& self);
  bool join(std::uint64_t seen);
  void leave();

  std::vector<std::unique_ptr<Worker>> workers_;
  std::size_t most_workers_ = SIZE_MAX;  ///< fewer once the system gave no more
  std::optional<LoopTask> task_;         ///< of the loop that is open
  std::atomic<int> caller_processor_{-1};
  /// Long loops gain more by a worker that runs half of the time than they lose by the waits for it.
  Governor governor_{16};
  /// What all threads agree by, see team.cpp.
  alignas(64) std::atomic<std::uint64_t> word_{0};
  alignas(64) std::atomic<std::uint32_t> caller_sleeps_{0};
};

}  // namespace mallow

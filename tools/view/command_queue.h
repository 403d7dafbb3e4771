#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

namespace mallow::view {

/// What one thread asks another one to do, in order. Commands are run by whoever takes them.
template <class Command>
class CommandQueue {
 public:
  void add(Command command) {
    {
      const std::lock_guard lock(mutex_);
      commands_.push_back(std::move(command));
    }
    added_.notify_one();
  }
  /// All that wait, in order.
  std::vector<Command> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(commands_, {});
  }
  /// Returns when there is something to take, or after some time.
  void wait_for(std::chrono::microseconds longest) {
    std::unique_lock lock(mutex_);
    added_.wait_for(lock, longest, [&] { return !commands_.empty(); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable added_;
  std::vector<Command> commands_;
};

}  // namespace mallow::view

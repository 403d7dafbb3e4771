#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace mallow::bench {

/// Other work on this machine: threads that never wait.
class BusyLoops {
 public:
  explicit BusyLoops(int count) {
    for (int k = 0; k < count; ++k)
      threads_.emplace_back([this] {
        while (!stop_.load(std::memory_order_relaxed)) {
        }
      });
  }
  ~BusyLoops() {
    stop_.store(true);
    for (std::thread& thread : threads_) thread.join();
  }
  BusyLoops(const BusyLoops&) = delete;
  BusyLoops& operator=(const BusyLoops&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace mallow::bench

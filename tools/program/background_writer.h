#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace mallow::program {

/// Writes files on a thread of its own, in the order in which they are given, while the next frame is
/// computed. A job that throws is the last one: what follows it would leave a gap.
class BackgroundWriter {
 public:
  BackgroundWriter();
  /// Finishes what is waiting. What that throws is lost: call finish() where it counts.
  ~BackgroundWriter();
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  /// Takes a job, after a wait for room. Throws what an earlier job has thrown, and takes none then.
  void add(std::function<void()> job);
  /// Whether add() would take a job without a wait.
  bool has_room();
  /// Waits until all jobs are done. Throws what one of them has thrown.
  void finish();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;  ///< the first is being done
  std::exception_ptr error_;
  bool closed_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace mallow::program

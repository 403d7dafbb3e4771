#pragma once

#include <cstddef>
#include <memory>

#include "mallow/export.h"

namespace mallow {

/// One loop of the engine, as an executor sees it: blocks of particles that any number of threads share.
class LoopTask {
 public:
  /// A loop as a function; it takes the place of the call, see operator().
  using Function = void (*)(void* loop, std::size_t place) noexcept;
  /// Made by the engine alone.
  LoopTask(Function function, void* loop) : function_(function), loop_(loop) {}

  /// Runs blocks until none is left. place: where this call begins to look for them; 0 for the thread that
  /// called Executor::run, other small numbers for others. Every number is right. A thread that has the same
  /// one in every loop finds its particles in its cache.
  void operator()(std::size_t place) const noexcept { function_(loop_, place); }

 private:
  Function function_;
  void* loop_;
};

/// Runs the loops of simulations and surfaces on threads: the engine's own, OpenMP's, or those that an
/// application has already. Results never depend on the executor, nor on how many threads join a loop; their
/// number may change from loop to loop. A step runs about 16 loops of 5 to 500 µs for every 10,000 particles.
///
/// An application's own, on a pool with an enqueue() whose result can be waited for:
///
///     void run(int threads, mallow::LoopTask task) override {
///       std::vector<Handle> others;
///       for (int k = 1; k < threads; ++k) others.push_back(pool.enqueue([=] { task(k); }));
///       task(0);
///       for (Handle& other : others) other.cancel_or_wait();
///     }
class MALLOW_EXPORT Executor {
 public:
  virtual ~Executor() = default;

  /// Threads that can work on one loop, the calling one included, >= 1: what a thread count of 0 means.
  virtual int concurrency() const = 0;

  /// Calls `task` on this thread and on at most threads − 1 others, each at most once. None of the others has
  /// to come; whoever does may come late. Returns when every call that has begun has ended; none may begin
  /// after that. Simulations on different threads may call it at the same time. It must not throw.
  /// threads: >= 2.
  virtual void run(int threads, LoopTask task) = 0;
};

/// The engine's own threads, the default. A loop does not wait for a thread that the system has not let run
/// yet: those that come in time help, the caller does the rest. Where threads lose their processors in the
/// middle of short loops, loops run on one thread for a while. Idle threads spin for 50 µs, then sleep.
/// Simulations on several threads at once share the processors: together they use no more threads than there
/// are. Threads are kept for later loops and end with the program; a process that was forked off starts new
/// ones.
MALLOW_EXPORT std::shared_ptr<Executor> team_executor();

/// OpenMP's threads, for programs that use OpenMP anyway. A loop of OpenMP ends when all its threads have
/// been there; where something else runs too, that can take time slices of the system. So after a long wait
/// loops run on one thread for 8 to 64 times as long as it lasted.
MALLOW_EXPORT std::shared_ptr<Executor> openmp_executor();

}  // namespace mallow

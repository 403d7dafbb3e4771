#include "core/team.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <new>
#include <thread>

#include "core/port.h"
#include "core/processors.h"

#ifdef __unix__
#include <pthread.h>
#endif

namespace mallow {
namespace {

using Clock = Governor::Clock;

// The word, from its lowest bits on: the number of workers inside; whether the loop is open; whether the
// caller sleeps until nobody is inside; whether the team ends; how many workers may join; the loop's number.
// A worker that read all of it and joins by compare-and-swap joins the loop that it read.
constexpr std::uint64_t k_one_inside = 1, k_inside = 0xffff;
constexpr std::uint64_t k_open = 1u << 16, k_caller_sleeps = 1u << 17, k_end = 1u << 18;
constexpr int k_helpers_shift = 19, k_epoch_shift = 32;
constexpr std::uint64_t k_helpers = 0x1fff;

std::uint64_t epoch(std::uint64_t word) {
  return word >> k_epoch_shift;
}
std::uint64_t helpers(std::uint64_t word) {
  return word >> k_helpers_shift & k_helpers;
}

/// Longer than the serial parts of a step, shorter than what anybody else on the processor would notice.
constexpr std::chrono::microseconds k_spin{50};
/// Between two looks at the clock, about 2 µs.
constexpr int k_spins = 64;

/// Spins until done() or the time is over; says which.
template <class Done>
bool spin_until(const Done& done) {
  for (Clock::time_point end{};;) {
    for (int k = 0; k < k_spins; ++k) {
      if (done()) return true;
      relax();
    }
    const Clock::time_point now = Clock::now();
    if (end == Clock::time_point{}) end = now + k_spin;
    if (now > end) return false;
  }
}

}  // namespace

struct Team::Worker {
  std::size_t index;
  alignas(64) std::atomic<std::uint32_t> sleeps{0};
  std::thread thread = {};
};

Team::Team() = default;
Team::~Team() {
  word_.fetch_or(k_end);
  for (const auto& worker : workers_) {
    worker->sleeps.store(0);
    worker->sleeps.notify_one();
  }
  for (const auto& worker : workers_) worker->thread.join();
}

std::size_t Team::make_workers(std::size_t count) noexcept {
  count = std::min({count, most_workers_, static_cast<std::size_t>(k_helpers)});
  try {
    while (workers_.size() < count) {
      auto worker = std::make_unique<Worker>();
      worker->index = workers_.size();
      workers_.reserve(workers_.size() + 1);
      worker->thread = std::thread([this, self = worker.get()] { work(*self); });
      workers_.push_back(std::move(worker));
    }
  } catch (const std::exception&) {
    most_workers_ = workers_.size();
  }
  return std::min(count, workers_.size());
}

void Team::run(int threads, LoopTask task) noexcept {
  const Clock::time_point begin = Clock::now();
  if (!governor_.allows(begin)) {
    task(0);
    return;
  }
  const std::size_t count = make_workers(static_cast<std::size_t>(threads) - 1);
  task_ = task;
  const std::uint64_t next = epoch(word_.load(std::memory_order_relaxed)) + 1;
  word_.store(next << k_epoch_shift | count << k_helpers_shift | k_open);
  wake(count);
  task(0);
  const Clock::time_point done = Clock::now();
  Clock::time_point end = done;
  if ((word_.fetch_and(~k_open, std::memory_order_acq_rel) & k_inside) != 0) {
    wait_for_those_inside();
    end = Clock::now();
  }
  governor_.ended(done - begin, end - done, end);
}

void Team::wake(std::size_t helpers) {
  for (std::size_t k = 0; k < helpers; ++k) {
    Worker& worker = *workers_[k];
    if (worker.sleeps.load() == 0) continue;
    caller_processor_.store(current_processor(), std::memory_order_relaxed);
    worker.sleeps.store(0);
    worker.sleeps.notify_one();
  }
}

void Team::wait_for_those_inside() {
  const auto nobody = [&] { return (word_.load(std::memory_order_acquire) & k_inside) == 0; };
  if (spin_until(nobody)) return;
  // One of them does not run; this processor may be the one that it needs.
  caller_sleeps_.store(1, std::memory_order_relaxed);
  if ((word_.fetch_or(k_caller_sleeps, std::memory_order_acq_rel) & k_inside) == 0) return;
  caller_sleeps_.wait(1, std::memory_order_acquire);
}

bool Team::join(std::uint64_t seen) {
  std::uint64_t word = seen;
  while ((word & k_open) != 0 && epoch(word) == epoch(seen))
    if (word_.compare_exchange_weak(word, word + k_one_inside, std::memory_order_acquire)) return true;
  return false;
}

void Team::leave() {
  const std::uint64_t before = word_.fetch_sub(k_one_inside, std::memory_order_acq_rel);
  if ((before & k_caller_sleeps) == 0 || (before & k_inside) != 1) return;
  caller_sleeps_.store(0, std::memory_order_release);
  caller_sleeps_.notify_one();
}

void Team::work(Worker& self) {
  use_all_processors();
  std::uint64_t seen = 0;
  const auto called = [&] {
    const std::uint64_t word = word_.load();
    if ((word & k_end) != 0) return true;
    if (epoch(word) == epoch(seen) || self.index >= helpers(word)) return false;
    seen = word;
    return true;
  };
  for (;;) {
    if (!spin_until(called)) {
      self.sleeps.store(1);
      if (called()) {
        self.sleeps.store(0);
      } else {
        self.sleeps.wait(1);
        const int caller = caller_processor_.load(std::memory_order_relaxed);
        if (caller >= 0 && caller == current_processor()) leave_processor(caller);
        continue;
      }
    }
    if ((word_.load(std::memory_order_relaxed) & k_end) != 0) return;
    if (!join(seen)) continue;
    (*task_)(self.index + 1);
    leave();
  }
}

namespace {

/// Teams of callers that have none at the moment, for the next ones; each caller has one during a loop.
/// Without a lock, because a process may be forked off at any time.
class Teams final : public Executor {
 public:
  int concurrency() const override { return processors_; }

  void run(int threads, LoopTask task) override {
    // Threads that share a processor gain nothing: each caller leaves one to each of the others.
    const int others = callers_.fetch_add(1, std::memory_order_relaxed);
    const int most = std::min(threads, processors_ - others);
    if (Team* const team = most > 1 ? take() : nullptr) {
      team->run(most, task);
      give_back(team);
    } else {
      task(0);
    }
    callers_.fetch_sub(1, std::memory_order_relaxed);
  }

  /// Ends the threads of all teams that have no caller.
  void end() {
    for (std::atomic<Team*>& place : idle_) delete place.exchange(nullptr);
  }
  /// In a process that was forked off: neither their threads nor other callers are here.
  void forget() {
    callers_.store(0);
    for (std::atomic<Team*>& place : idle_) place.store(nullptr);
  }

 private:
  Team* take() {
    for (std::atomic<Team*>& place : idle_)
      if (place.load(std::memory_order_relaxed))
        if (Team* team = place.exchange(nullptr, std::memory_order_acquire)) return team;
    return new (std::nothrow) Team;
  }
  void give_back(Team* team) {
    for (std::atomic<Team*>& place : idle_) {
      Team* none = nullptr;
      if (place.compare_exchange_strong(none, team, std::memory_order_release)) return;
    }
    delete team;
  }

  const int processors_ = processor_count();
  alignas(64) std::atomic<int> callers_{0};  ///< that are in a loop
  alignas(64) std::array<std::atomic<Team*>, 64> idle_{};
};

/// Never destroyed: threads may step simulations while the program ends.
Teams& teams() {
  static Teams& all = *[] {
    auto* const made = new Teams;
#ifdef __unix__
    pthread_atfork(nullptr, nullptr, [] { teams().forget(); });
#endif
    return made;
  }();
  return all;
}

struct EndTeams {
  ~EndTeams() { teams().end(); }
};

}  // namespace

std::shared_ptr<Executor> team_executor() {
  static const EndTeams at_exit;
  return {std::shared_ptr<void>(), &teams()};
}

}  // namespace mallow

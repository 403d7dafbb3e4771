#pragma once

#include <algorithm>
#include <chrono>

namespace mallow {

/// Keeps threads from being used where one that is waited for does not get to run: a wait of more than
/// k_long means one thread for a pause, twice as long each time, until k_good loops in a row went well. A
/// pause is also so long that the wait before it takes a tenth of the time at most.
class Governor {
 public:
  using Clock = std::chrono::steady_clock;
  /// A wait that no uneven share of blocks explains, and a time slice of the system exceeds.
  static constexpr std::chrono::microseconds k_long{150};
  /// About a time slice: what else runs on that core may be done then.
  static constexpr std::chrono::milliseconds k_shortest_pause{4}, k_longest_pause{256};
  static constexpr int k_good = 1000;
  static constexpr int k_times_the_wait = 10;

  /// Whether more than one thread may be used now.
  bool allows(Clock::time_point now) const { return now >= resume_; }

  /// What the caller waited for other threads in a loop that ended `now`.
  void waited(Clock::duration wait, Clock::time_point now) {
    if (wait > k_long) {
      pause_ = pause_ == Clock::duration::zero() ? Clock::duration(k_shortest_pause)
                                                 : std::min(2 * pause_, Clock::duration(k_longest_pause));
      resume_ = now + std::max(pause_, k_times_the_wait * wait);
      good_ = 0;
    } else if (++good_ == k_good) {
      pause_ = Clock::duration::zero();
    }
  }

 private:
  Clock::time_point resume_{};
  Clock::duration pause_{};
  int good_ = 0;
};

}  // namespace mallow

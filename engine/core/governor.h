#pragma once

#include <algorithm>
#include <chrono>

namespace mallow {

/// Keeps loops on one thread for a while where another that was waited for did not get to run. A long wait is
/// followed by a pause 8 times as long, the next by one 16 times as long, and so on up to 64, so that waits
/// take a ninth of the time at most and soon a 65th; after k_good loops without such a wait it begins again
/// with 8. So a single long wait on an idle machine costs next to nothing.
class Governor {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int k_shortest_pause = 8, k_longest_pause = 64;  ///< in waits
  /// More than the loops of short steps between two losses of a processor, some 5 ms.
  static constexpr int k_good = 4000;
  /// Waits up to this are cheaper than a pause.
  static constexpr std::chrono::microseconds k_short{50};

  /// tolerated: waits up to so many times the caller's own work in a loop are no reason for a pause, >= 2, as
  /// the last blocks of a loop take different times.
  explicit Governor(int tolerated) : tolerated_(tolerated) {}

  /// Whether more than one thread may be used now.
  bool allows(Clock::time_point now) const { return now >= resume_; }

  /// A loop of several threads ended `now`, in which the caller worked for `own` and waited for `wait`.
  void ended(Clock::duration own, Clock::duration wait, Clock::time_point now) {
    if (wait <= k_short || wait <= tolerated_ * own) {
      if (++good_ == k_good) pause_ = k_shortest_pause;
      return;
    }
    resume_ = now + pause_ * wait;
    pause_ = std::min(2 * pause_, k_longest_pause);
    good_ = 0;
  }

 private:
  Clock::time_point resume_{};
  int tolerated_;
  int pause_ = k_shortest_pause;
  int good_ = 0;
};

}  // namespace mallow

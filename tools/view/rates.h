#pragma once

#include <deque>

#include "mallow/report.h"

namespace mallow::view {

/// How often something happens, and what it takes, over the last second.
class Rate {
 public:
  /// wall: [s]. amount: what counts, 1 for events.
  void add(double wall, double amount = 1) {
    entries_.push_back({wall, amount});
    forget(wall);
  }
  /// A second of wall time [1/s].
  double per_second(double wall) {
    forget(wall);
    double sum = 0;
    for (const Entry& entry : entries_) sum += entry.amount;
    return sum;
  }
  /// Of an entry; 0 where there is none.
  double mean() const {
    double sum = 0;
    for (const Entry& entry : entries_) sum += entry.amount;
    return entries_.empty() ? 0 : sum / static_cast<double>(entries_.size());
  }
  void clear() { entries_.clear(); }

 private:
  struct Entry {
    double wall, amount;
  };
  void forget(double wall) {
    while (!entries_.empty() && entries_.front().wall < wall - 1) entries_.pop_front();
  }
  std::deque<Entry> entries_;
};

/// Mean times of phases over about the last thirty steps.
class MeanPhases {
 public:
  void add(const PhaseTimes& seconds) {
    constexpr double k_new = 1.0 / 30;
    for (std::size_t k = 0; k < k_phase_count; ++k)
      mean_[k] = any_ ? (1 - k_new) * mean_[k] + k_new * seconds[k] : seconds[k];
    any_ = true;
  }
  const PhaseTimes& mean() const { return mean_; }
  void clear() { *this = {}; }

 private:
  PhaseTimes mean_{};
  bool any_ = false;
};

}  // namespace mallow::view

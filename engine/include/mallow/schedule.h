#pragma once

#include <initializer_list>
#include <utility>
#include <vector>

#include "mallow/export.h"

namespace mallow {

/// One key of a schedule: the number is `value` at `time` [s].
struct ScheduleKey {
  float time;
  float value;
};

/// A number over simulated time: piecewise linear between keys, constant before the first and after the
/// last. One number is a schedule of one key. Valid: at least one key, times finite and strictly increasing,
/// every value in the range of what it sets.
class MALLOW_EXPORT Schedule {
 public:
  /// The same number at all times.
  Schedule(float value = 0.0f) : keys_{{0.0f, value}} {}  // NOLINT: a number is a schedule
  /// Keys in order of time.
  Schedule(std::vector<ScheduleKey> keys) : keys_(std::move(keys)) {}  // NOLINT
  /// @copydoc Schedule(std::vector<ScheduleKey>)
  Schedule(std::initializer_list<ScheduleKey> keys) : keys_(keys) {}

  /// The number at a time [s].
  float at(double time) const;
  /// The smallest and the largest that it ever is.
  float lowest() const;
  /// @copydoc lowest()
  float highest() const;
  /// As given.
  const std::vector<ScheduleKey>& keys() const { return keys_; }

 private:
  std::vector<ScheduleKey> keys_ = {};
};

}  // namespace mallow

#include <algorithm>

#include "mallow/schedule.h"

namespace mallow {
namespace {

bool less(const ScheduleKey& a, const ScheduleKey& b) {
  return a.value < b.value;
}

}  // namespace

float Schedule::at(double time) const {
  const auto after = std::upper_bound(keys_.begin(), keys_.end(), time, [](double t, const ScheduleKey& key) {
    return t < static_cast<double>(key.time);
  });
  if (after == keys_.begin()) return keys_.front().value;
  if (after == keys_.end()) return keys_.back().value;
  const ScheduleKey& a = *(after - 1);
  const ScheduleKey& b = *after;
  const double s =
      (time - static_cast<double>(a.time)) / (static_cast<double>(b.time) - static_cast<double>(a.time));
  return static_cast<float>((1.0 - s) * static_cast<double>(a.value) + s * static_cast<double>(b.value));
}

float Schedule::lowest() const {
  return std::min_element(keys_.begin(), keys_.end(), less)->value;
}

float Schedule::highest() const {
  return std::max_element(keys_.begin(), keys_.end(), less)->value;
}

}  // namespace mallow

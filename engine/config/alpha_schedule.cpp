#include <algorithm>

#include "mallow/material.h"

namespace mallow {
namespace {

bool less_alpha(const AlphaKey& a, const AlphaKey& b) {
  return a.alpha < b.alpha;
}

}  // namespace

float AlphaSchedule::at(double time) const {
  const auto after = std::upper_bound(keys_.begin(), keys_.end(), time, [](double t, const AlphaKey& key) {
    return t < static_cast<double>(key.time);
  });
  if (after == keys_.begin()) return keys_.front().alpha;
  if (after == keys_.end()) return keys_.back().alpha;
  const AlphaKey& a = *(after - 1);
  const AlphaKey& b = *after;
  const double s =
      (time - static_cast<double>(a.time)) / (static_cast<double>(b.time) - static_cast<double>(a.time));
  return static_cast<float>((1.0 - s) * static_cast<double>(a.alpha) + s * static_cast<double>(b.alpha));
}

float AlphaSchedule::lowest() const {
  return std::min_element(keys_.begin(), keys_.end(), less_alpha)->alpha;
}

float AlphaSchedule::highest() const {
  return std::max_element(keys_.begin(), keys_.end(), less_alpha)->alpha;
}

}  // namespace mallow

#include "view/slider_span.h"

#include <algorithm>
#include <cmath>

namespace mallow::view {
namespace {

/// Ends that are there lest numbers overflow are none for the hand.
constexpr double k_far = 1e6;
/// From a value to the ends of its slider, where its range has none.
constexpr double k_factor = 30;

}  // namespace

SliderSpan slider_span(const Range& range, double value) {
  const bool has_low = range.lowest > -k_far, has_high = range.highest < k_far;
  const double size = value != 0 ? std::abs(value) : 1;
  if (!has_low) return {-10 * size, has_high ? range.highest : 10 * size, false};
  if (range.above_lowest && range.lowest == 0)
    return {size / k_factor, has_high ? range.highest : size * k_factor, true};
  const double high = has_high ? range.highest : std::max(range.lowest + 1, 10 * size);
  const bool wide = range.lowest > 0 && high / range.lowest > 50;
  return {range.lowest, high, wide};
}

double value_at(const SliderSpan& span, double share) {
  if (span.by_factors) return span.low * std::pow(span.high / span.low, share);
  return span.low + share * (span.high - span.low);
}

}  // namespace mallow::view

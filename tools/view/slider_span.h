#pragma once

#include "config/field.h"

namespace mallow::view {

/// What a slider of a setting goes over.
struct SliderSpan {
  double low = 0, high = 1;
  bool by_factors = false;  ///< the same way multiplies the value by the same factor
};
/// The range of a setting where that has ends; around `value` where it has none.
SliderSpan slider_span(const Range& range, double value);
/// share: in [0, 1], of the way.
double value_at(const SliderSpan& span, double share);

}  // namespace mallow::view

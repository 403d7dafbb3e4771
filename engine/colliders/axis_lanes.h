#pragma once

// The axis of a shape of revolution, for lanes. Numbers: start, direction (unit length), length.
#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

struct AxisLanes {
  const float *start, *direction;
  float length;
  float across[3];  ///< one of the directions across the axis, for points on it

  explicit AxisLanes(const float* numbers) : start(numbers), direction(numbers + 3), length(numbers[6]) {
    // The part across of the unit vector that is least along.
    const auto size = [&](int k) { return direction[k] < 0 ? -direction[k] : direction[k]; };
    const int least = size(0) <= size(1) ? (size(0) <= size(2) ? 0 : 2) : (size(1) <= size(2) ? 1 : 2);
    float square = 0;
    for (int k = 0; k < 3; ++k) {
      across[k] = (k == least ? 1.0f : 0.0f) - direction[least] * direction[k];
      square += across[k] * across[k];
    }
    for (float& component : across) component /= root(square);
  }
};

}  // namespace
}  // namespace mallow::MALLOW_LEVEL

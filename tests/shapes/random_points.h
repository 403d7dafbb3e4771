#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/vec3.h"

namespace mallow {

/// The same points, uniform in a box, for every run.
inline std::vector<Vec3> random_points(std::size_t count, const Vec3& min, const Vec3& max) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  std::vector<Vec3> points(count);
  for (Vec3& x : points) x = min + Vec3(share(random), share(random), share(random)).cwiseProduct(max - min);
  return points;
}

/// Distance to the nearest of many points.
inline float brute_force_distance(const std::vector<Vec3>& points, const Vec3& x) {
  float best = std::numeric_limits<float>::infinity();
  for (const Vec3& point : points) best = std::min(best, (x - point).squaredNorm());
  return std::sqrt(best);
}

/// The first problem of the ConfigError that `call` throws: "field: message", or "nothing thrown".
template <class Call>
std::string problem_of(const Call& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return to_string(error.problems().front());
  }
  return "nothing thrown";
}

}  // namespace mallow

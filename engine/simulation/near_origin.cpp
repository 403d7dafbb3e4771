#include "simulation/near_origin.h"

#include <cmath>

namespace mallow {
namespace {

constexpr float k_far = 1000;  // in spacings

}  // namespace

Vec3 choose_origin(const Body& body) {
  Vec3 low = body.positions.front(), high = low;
  for (const Vec3& x : body.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  Vec3 origin = 0.5f * low + 0.5f * high;
  for (float& c : origin) c = std::abs(c) > k_far * body.spacing ? std::round(c) : 0.0f;
  return origin;
}

Vec3 relative_to(const Vec3& origin, const Vec3& x) {
  return (x.cast<double>() - origin.cast<double>()).cast<float>();
}

}  // namespace mallow

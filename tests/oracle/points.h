#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "mallow/vec3.h"

namespace mallow::oracle {

/// Points of a cubic lattice about a centre, each moved by up to ± jitter · spacing per axis; the same on
/// every machine, as only the generator of <random> is used, whose bits the standard fixes.
inline std::vector<Vec3> lattice_points(std::array<int, 3> count, float spacing,
                                        const Vec3& center = {0, 0, 0}, float jitter = 0,
                                        std::uint32_t seed = 1) {
  std::mt19937 generator(seed);
  const auto moved = [&] {
    return jitter * (2.0f * static_cast<float>(generator() >> 8) / static_cast<float>(1 << 24) - 1.0f);
  };
  const auto from_middle = [](int i, int n) {
    return static_cast<float>(i) - 0.5f * static_cast<float>(n - 1);
  };
  std::vector<Vec3> points;
  for (int z = 0; z < count[2]; ++z) {
    for (int y = 0; y < count[1]; ++y) {
      for (int x = 0; x < count[0]; ++x) {
        const float dx = moved(), dy = moved(), dz = moved();
        points.push_back(center + spacing * Vec3(from_middle(x, count[0]) + dx, from_middle(y, count[1]) + dy,
                                                 from_middle(z, count[2]) + dz));
      }
    }
  }
  return points;
}

}  // namespace mallow::oracle

#include "render/sampling.h"

#include <cmath>
#include <numbers>

namespace mallow::render {

std::uint32_t hash(std::uint32_t x, std::uint32_t y) {
  // pcg2d's mixing (Jarzynski & Olano 2020)
  std::uint32_t a = x * 1664525u + 1013904223u;
  std::uint32_t b = y * 1664525u + 1013904223u;
  a += b * 1664525u;
  b += a * 1664525u;
  a ^= a >> 16;
  b ^= b >> 16;
  a += b * 1664525u;
  b += a * 1664525u;
  return b ^ (b >> 16) ^ a;
}

Point2 sobol(std::uint32_t i) {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  std::uint32_t v1 = 1u << 31;
  std::uint32_t v2 = 1u << 31;
  for (; i != 0; i >>= 1, v1 >>= 1, v2 ^= v2 >> 1) {
    if ((i & 1u) == 0) continue;
    first ^= v1;
    second ^= v2;
  }
  return {unit(first), unit(second)};
}

Point2 to_disc(const Point2& square) {
  constexpr float k_quarter_pi = std::numbers::pi_v<float> / 4;
  const float a = 2 * square.x() - 1;
  const float b = 2 * square.y() - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const float radius = wide ? a : b;
  const float angle = wide ? k_quarter_pi * b / a : k_quarter_pi * (2 - a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

Tangents tangents(const Vec3& n) {
  const float sign = std::copysign(1.0f, n.z());
  const float a = -1 / (sign + n.z());
  const float b = n.x() * n.y() * a;
  return {{1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()}, {b, sign + n.y() * n.y() * a, -n.y()}};
}

InterleavedDisc::InterleavedDisc(int samples_per_pixel) {
  const auto count = static_cast<std::uint32_t>(k_tile * k_tile * samples_per_pixel);
  points_.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) points_.push_back(to_disc(sobol(i)));
}

const Point2& InterleavedDisc::at(int x, int y, int k) const {
  // Bayer's matrix: pixels next to each other get parts of the set that are far apart.
  constexpr std::array<std::uint8_t, 16> k_order{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  const std::size_t pixel = k_order[static_cast<std::size_t>((y % k_tile) * k_tile + x % k_tile)];
  return points_[static_cast<std::size_t>(k) * k_tile * k_tile + pixel];
}

}  // namespace mallow::render

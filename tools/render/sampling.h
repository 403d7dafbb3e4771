#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mallow/vec3.h"

namespace mallow::render {

/// A point of the unit square.
using Point2 = Eigen::Vector2f;

/// 32 well-mixed bits of a pixel: the only source of chance here, so that threads cannot matter.
std::uint32_t hash(std::uint32_t x, std::uint32_t y);
/// In [0, 1).
inline float unit(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

/// Point i of the (0,2)-sequence of van der Corput and Sobol: any 2^k aligned ones in a row are stratified.
Point2 sobol(std::uint32_t i);
/// Area-preserving map of the unit square to the unit disc (Shirley & Chiu 1997).
Point2 to_disc(const Point2& square);

/// Two unit vectors that make a right-handed frame with a unit normal (Duff et al. 2017).
struct Tangents {
  Vec3 u, v;
};
Tangents tangents(const Vec3& normal);

/// Interleaved sampling (Keller & Heidrich 2001): the points of one large stratified set are dealt out to the
/// pixels of a 4 × 4 tile, so that every 4 × 4 window of the picture holds the whole set, and averaging over
/// it leaves no noise. (Moving the points from tile to tile was tried: it trades bands that nobody sees for
/// grain that everybody does.)
class InterleavedDisc {
 public:
  static constexpr int k_tile = 4;
  explicit InterleavedDisc(int samples_per_pixel);
  /// Point k of a pixel, in the unit disc, below samples_per_pixel.
  const Point2& at(int x, int y, int k) const;

 private:
  std::vector<Point2> points_;  // sample, pixel of the tile: those of one sample are stratified too
};

}  // namespace mallow::render

#pragma once

#include <filesystem>
#include <vector>

#include "mallow/vec3.h"

namespace mallow::render {

/// A picture of all directions: rows from straight up to straight down, columns once around z.
struct HdrPicture {
  int width = 0;
  int height = 0;
  std::vector<Vec3> radiance;  ///< linear RGB, >= 0

  /// In a direction, between the four pixels around it.
  Vec3 at(const Vec3& direction) const;
  /// The middle of a pixel.
  Vec3 direction(int x, int y) const;
  /// Solid angle of a pixel of row y [sr].
  float solid_angle(int y) const;
  /// Calls visit(direction, solid angle, radiance) for every pixel.
  template <class Visit>
  void for_pixels(const Visit& visit) const {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        visit(direction(x, y), solid_angle(y),
              radiance[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)]);
  }
  /// The same with sides of at most so many pixels, each the mean of what it covers.
  HdrPicture shrunk(int most_width, int most_height) const;
};

/// Reads a Radiance picture (.hdr, RGBE) of all around; one with a value above 1e6 is made darker as a whole.
/// Throws IoError where the file cannot be read, is none or not whole, or is larger than 16384 pixels along a
/// side or 2^26 in all.
HdrPicture read_hdr(const std::filesystem::path& file);

}  // namespace mallow::render

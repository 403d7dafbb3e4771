#pragma once

#include <cstdint>

#include "mallow/vec3.h"

namespace mallow {

/// How the surface of a body answers light, in pictures.
enum class Finish : std::uint8_t {
  jelly,  ///< clear and a little cloudy: light is bent at its surface (index 1.35) and coloured by the depth
  clay,   ///< opaque, dull and rough
  cream,  ///< light goes in and comes out near by: soft shades, a satin sheen
  gloss,  ///< opaque under a smooth coat (index 1.5): chocolate, ketchup
  syrup,  ///< as clear as glass (index 1.45), coloured by the depth: honey, water
};

/// What a body looks like, in pictures and in files that tell of looks; it has no part in the motion.
struct Appearance {
  Vec3 color{0.8f, 0.8f, 0.8f};  ///< diffuse albedo, linear RGB in [0, 1]
  Finish finish = Finish::jelly;
};

}  // namespace mallow

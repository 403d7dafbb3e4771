#pragma once

#include <cstdint>

#include "mallow/vec3.h"

namespace mallow {

/// How the surface of a body answers light, in pictures.
enum class Finish : std::uint8_t {
  jelly,  ///< translucent and glossy
  clay,   ///< opaque, dull and soft
};

/// What a body looks like, in pictures and in files that tell of looks; it has no part in the motion.
struct Appearance {
  Vec3 color{0.8f, 0.8f, 0.8f};  ///< diffuse albedo, linear RGB in [0, 1]
  Finish finish = Finish::jelly;
};

}  // namespace mallow

#pragma once

#include "mallow/scene.h"
#include "textbook/textbook.h"

namespace mallow::textbook {

/// A scene that build() takes, as build() makes it: the same groups, particles and ids. `threads` are those
/// of sampling. Throws ConfigError where it says what the textbook does not know: emitters, sinks, heat,
/// adhesion, the pressure of walls, particles that differ, bodies that merge or split. Throws ConfigError or
/// IoError where a body cannot be sampled.
Textbook from_scene(const Scene& scene, int threads = 0);

}  // namespace mallow::textbook

#pragma once

#include "program/compare.h"
#include "render/renderer.h"

namespace mallow::program {

/// B's particles of a frame, between its colliders, coloured by how far they are from A's: light grey where
/// they are at the same place, over yellow to red where they are `frame.largest` spacings apart or only in B.
/// Seen as the scene says, where a run has one. Throws IoError.
render::Image difference_picture(const ComparedStates& a, const ComparedStates& b,
                                 const FrameDifference& frame, int threads);

}  // namespace mallow::program

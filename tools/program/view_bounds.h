#pragma once

#include "mallow/files.h"
#include "mallow/scene.h"

namespace mallow::program {

/// What the camera has to have in view through a whole film, as far as frame 0 and the scene tell: the
/// particles of frame 0, the ground below them, how bodies that are thrown fly, what emitters reach and heap
/// up, and the visible colliders near by, where their keyframes take them too. The same for any number of
/// frames, so that a film that is made longer keeps its camera.
Aabb view_bounds(const Scene& scene, const ParticleFrame& first);

/// The colliders of a scene that are seen.
std::vector<Collider> visible_colliders(const Scene& scene);

}  // namespace mallow::program

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mallow/simulation.h"
#include "view/camera.h"
#include "view/rewind_ring.h"

/// What the mouse does to matter, beside the grab. Each returns what it did in a sentence, and throws what
/// the simulation throws.
namespace mallow::view {

/// A ball of matter from the eye along the ray. radius: [m], > 0. speed: [m/s].
struct Throw {
  float radius = 1;
  float speed = 1;
};
BodyId throw_ball(Simulation& simulation, MaterialId material, const Ray& ray, float spacing,
                  const Throw& ball);

/// Hits what the ray meets, so that it is as fast as `speed` in its middle [m/s].
std::string poke(Simulation& simulation, const Ray& ray, float radius, float speed);
/// Takes away a layer between two rays of one eye, wide enough that no region reaches across.
std::string cut(Simulation& simulation, const Ray& from, const Ray& to);
/// Warms what is around the place that the ray meets by up to `kelvins`; matter that carries no heat melts:
/// its alpha rises by up to `softer`.
std::string heat(Simulation& simulation, const Ray& ray, float radius, float kelvins, float softer);
/// Holds what is around the place that the ray meets where it is, and gives it.
HandPin pin(Simulation& simulation, const Ray& ray, float radius);
/// What the ray meets first. Throws ConfigError where that is nothing.
BodyHit hit_of(const Simulation& simulation, const Ray& ray);
/// Where a particle is, if it is still there.
std::optional<std::size_t> row_of(const Simulation& simulation, ParticleId id);

/// What the mouse has at hand, as far as a scene is large: a seventh of its size, three spacings at least.
float reach_of(const Simulation& simulation);

}  // namespace mallow::view

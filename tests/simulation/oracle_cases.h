#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mallow/collider.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/vec3.h"

namespace mallow {

/// Irregular points: a lattice about `center`, shaken by up to ± jitter · spacing.
struct Blob {
  Material material = {};
  Vec3 center{0, 0, 0};
  Vec3 velocity{0, 0, 0};
  std::array<int, 3> count{6, 6, 6};
  float spacing = 1.0f;
  float jitter = 0.2f;
  bool joins_the_one_before = false;  ///< into one group with it
};

struct Pinned {
  Aabb box;
  Vec3 velocity{0, 0, 0};
};

/// A scene that the oracle and the engine both run. Everything in it must matter: see ablations().
struct Case {
  std::string name;
  std::vector<Blob> blobs;
  std::vector<Collider> colliders = {};
  SolverConfig solver;
  std::vector<Pinned> pins = {};
  bool wind = false;        ///< a user force that depends on time, place, velocity and id
  bool limited = false;     ///< some step must be shorter than Δt0
  int updates = 0;          ///< updates of reference shapes that must happen, at least
  double tolerance = 1e-4;  ///< what single precision may do to a position in 40 steps, in units of h
};

const std::vector<Case>& oracle_cases();

/// The case without one of the things that it claims to test: a collider, a part of a union, friction,
/// bounce, motion, the pins, the wind, pressure, viscosity, cohesion, the updates. What is left out is
/// appended to the name.
std::vector<Case> ablations(const Case& whole);

}  // namespace mallow

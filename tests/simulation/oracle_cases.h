#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "mallow/collider.h"
#include "mallow/emitter.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/vec3.h"
#include "oracle/oracle.h"

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
  bool painted = false;               ///< see alphas_of() and stiffnesses_of()
  bool paints_yield = false;          ///< see yields_of()
  bool splits = false;                ///< Body::splits
};

struct Pinned {
  Aabb box;
  Vec3 velocity{0, 0, 0};
};

struct Nozzle {
  Emitter emitter;
  Material material;
  std::vector<Vec3> section;  ///< what its layers are, in this order
  double turn = 0;            ///< of a layer against the one before [rad]
};

/// Takes what is in a box, or outside of it.
struct Drain {
  Aabb box;
  bool outside = false;
};

/// A scene that the oracle and the engine both run. Everything in it must matter: see ablations().
struct Case {
  std::string name;
  std::vector<Blob> blobs;
  std::vector<Collider> colliders = {};
  SolverConfig solver;
  std::vector<Pinned> pins = {};
  std::vector<Nozzle> nozzles = {};
  std::vector<Drain> drains = {};
  bool wind = false;        ///< a user force that depends on time, place, velocity and id
  bool limited = false;     ///< some step must be shorter than Δt0
  int updates = 0;          ///< updates of reference shapes that must happen, at least
  bool flows = false;       ///< what flows must matter
  bool walls = false;       ///< that walls press as if they were filled must matter
  double tolerance = 1e-4;  ///< what single precision may do to a position in 40 steps, in units of h
};
std::ostream& operator<<(std::ostream& out, const Case& c);

const std::vector<Case>& oracle_cases();
/// Of them, those of the second chapter's damping: all others are undamped.
std::vector<Case> cases_of_damping();
/// Volume to a tolerance, yield that differs within a body.
std::vector<Case> cases_of_matter();
/// Strands that leave nozzles.
std::vector<Case> cases_of_strands();
/// Bodies that touch by constraint, sinks, and bodies that are torn.
std::vector<Case> cases_of_contact();
/// Heat, and what follows it.
std::vector<Case> cases_of_heat();

/// The case without one of the things that it claims to test: a collider, a part of a union, friction,
/// bounce, motion, the pins, damping, the wind, pressure, viscosity, cohesion, the updates, contact between
/// bodies, sinks. What is left out is appended to the name.
std::vector<Case> ablations(const Case& whole);

/// The points of a blob; the same for all who run the case.
std::vector<Vec3> points_of(const Blob& blob);
/// From 0 to 1 along x, and from 0.4 to 1.6 along y, of a blob that is painted; else none.
std::vector<float> alphas_of(const Blob& blob);
std::vector<float> stiffnesses_of(const Blob& blob);
/// From 0.01 to 0.3 along y, of a blob that paints its yield; else none.
std::vector<float> yields_of(const Blob& blob);
/// A gust that turns, tears and drags; the same formula for both precisions.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> wind(double time, std::size_t id, const Eigen::Matrix<Scalar, 3, 1>& x,
                                 const Eigen::Matrix<Scalar, 3, 1>& v) {
  const auto t = static_cast<Scalar>(time);
  const auto side = static_cast<Scalar>(id % 2 == 0 ? 0.2 : -0.1);
  return {Scalar(0.3) * x.x() + side, Scalar(0.2) * t - Scalar(0.1) * v.y(), Scalar(0.1) * x.x()};
}

oracle::Oracle oracle_of(const Case& scene);

using PlacesById = std::map<std::size_t, oracle::Vec>;
PlacesById places_of(const oracle::Oracle& oracle);
/// The largest distance of a particle from its twin, in spacings of its body; of those that both have.
double largest_deviation(const Case& scene, const PlacesById& a, const PlacesById& b);
/// The same where nothing has gone.
double largest_deviation(const Case& scene, const std::vector<oracle::Vec>& a,
                         const std::vector<oracle::Vec>& b);

}  // namespace mallow

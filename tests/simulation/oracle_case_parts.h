#pragma once

#include "paper_settings.h"
#include "simulation/oracle_cases.h"

/// What the oracle's cases are put together from.
namespace mallow {

/// The paper's free units, small: Δt0 0.15, h about 1, |g| 0.4, and the paper's settings; checks often enough
/// to fire within 40 steps.
inline SolverConfig units(float support_radius = 2.2f) {
  return with_paper_settings(SolverConfig{.support_radius = support_radius,
                                          .gravity = {0, 0, -0.4f},
                                          .update_interval = 10,
                                          .wall_pressure = false});
}

inline SolverConfig walled(float support_radius = 2.2f) {
  SolverConfig solver = units(support_radius);
  solver.wall_pressure = true;
  return solver;
}

inline SolverConfig printed() {
  SolverConfig solver = units();
  solver.formulation = Formulation::printed;
  return solver;
}

inline SolverConfig without_acoustic_limit() {
  SolverConfig solver = units();
  solver.acoustic_limit = false;
  return solver;
}

inline SolverConfig with_offset(float contact_offset) {
  SolverConfig solver = units();
  solver.contact_offset = contact_offset;
  return solver;
}

inline Material stuff(AlphaSchedule alpha) {
  return {.alpha = std::move(alpha), .update_threshold = 1.0f};
}
/// As stiff as pascals say.
inline Material firm(float alpha, float youngs_modulus) {
  return {.alpha = alpha, .update_threshold = 1.0f, .youngs_modulus = youngs_modulus};
}
/// Flows where it is strained.
inline Material dough(AlphaSchedule alpha, float yield, std::optional<float> creep = {}) {
  return {.alpha = std::move(alpha), .plastic_yield = yield, .plastic_creep = creep};
}
/// Keeps its first reference shape.
inline Material lasting(AlphaSchedule alpha) {
  return {.alpha = std::move(alpha), .update_threshold = 1e6f};
}

/// Nothing is pressed together.
inline SolverConfig full(SolverConfig solver, int iterations) {
  solver.volume_iterations = iterations;
  return solver;
}
inline const Plane k_tilted{{0.3f, -0.2f, 1.0f}, 0.1f};
inline const Collider k_slope{.shape = k_tilted, .restitution = 0.6f, .friction = 0.3f};
inline const Collider k_ball{.shape = Sphere{{0.4f, -0.3f, -3.0f}, 3.0f}, .friction = 0.3f};
inline const Collider k_bowl{.shape = Sphere{{0, 0, 6}, 6.2f, true}, .friction = 0.2f};
inline const Collider k_step{.shape = Box{{-9, -9, -2}, {0.3f, 9, 0.2f}}, .friction = 0.3f};
inline const Collider k_tank{.shape = Box{{-3.7f, -9, 0}, {9, 9, 20}, true}, .friction = 0.1f};
inline const Collider k_union{
    .shape = Union{{Sphere{{-2, 0, -1}, 2.0f}, Box{{0.5f, -2, -2}, {5, 2, 0.6f}}, Plane{{0, 0, 1}, -0.6f}}},
    .friction = 0.3f};

}  // namespace mallow

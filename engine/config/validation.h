#pragma once

#include <string>

#include "core/checks.h"
#include "mallow/body.h"
#include "mallow/emitter.h"
#include "mallow/export.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"

namespace mallow {

/// What the library refuses at its border. Each adds the problems of one value to `checks`.
void check(const SolverConfig& config, Checks& checks);
/// best: the highest level the machine has.
void check(InstructionLevel level, InstructionLevel best, Checks& checks);
void check(const AlphaSchedule& alpha, Checks& checks);
void check(const Material& material, Checks& checks);
/// Whether regions flow where they are strained.
inline bool flows(const Material& material) {
  return material.plastic_yield || material.plastic_yield_by_temperature;
}
/// What shape matching pulls in a step at most, a = (1 − α) Δt0/Δt_SM. In linear theory it stays bounded
/// below 4; rotation is not linear, and tumbling bodies gain 79% in 20,000 steps at 3.25, 6% at 3 and 2%
/// at 2.5. [model 2, section 4 B]
inline constexpr float k_stiffest = 2.5f;
/// The same where strain flows at once: what a step strains then pulls once and is gone, as in a liquid, and
/// velocities are bounded below 2 in linear theory, which is of regions as large as the body. At 2.5 free
/// bodies that flow from a strain of 0 gained 75 to 330 times their energy in 2000 steps, at 2.2 none.
inline constexpr float k_stiffest_flowing = 2.0f;
inline float most_pull(const Material& material) {
  return material.plastic_yield ? k_stiffest_flowing : k_stiffest;
}
/// Whether steps of this solver are short enough for the material's springs; of youngs_modulus see
/// simulation/stiffness.h. name: of the material, for messages that come where it is not obvious, or empty.
void check_stiffness(const SolverConfig& config, const Material& material, const std::string& name,
                     Checks& checks);
/// The same where the stiffest particle of a body has this share of the material's modulus. springs: the
/// material with an elastic_time_step in place of a modulus.
void check_elasticity(const SolverConfig& config, const Material& material, const Material& springs,
                      float share, Checks& checks);
/// Whether the damping of these springs leaves enough of what a step carries. where: "material 'jelly'" and
/// the like, for the message, or empty. softer: what allows more, beside a shorter step.
void check_damping(const SolverConfig& config, const Material& material, const std::string& where,
                   const char* softer, Checks& checks);
MALLOW_EXPORT void check(const Emitter& emitter, Checks& checks);
void check(const Body& body, Checks& checks);

}  // namespace mallow

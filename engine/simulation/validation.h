#pragma once

#include "core/checks.h"
#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"

namespace mallow {

/// What the library refuses at its border. Each adds the problems of one value to `checks`.
void check(const SolverConfig& config, Checks& checks);
/// best: the highest level the machine has.
void check(InstructionLevel level, InstructionLevel best, Checks& checks);
void check(const AlphaSchedule& alpha, Checks& checks);
void check(const Material& material, Checks& checks);
/// Whether steps of this solver are short enough for the material's springs.
void check_stiffness(const SolverConfig& config, const Material& material, Checks& checks);
void check(const Collider& collider, Checks& checks);
void check(const Body& body, Checks& checks);

}  // namespace mallow

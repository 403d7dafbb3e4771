#pragma once

/// All of target mallow::mallow.
#include "mallow/body.h"               // IWYU pragma: export
#include "mallow/collider.h"           // IWYU pragma: export
#include "mallow/defaults.h"           // IWYU pragma: export
#include "mallow/errors.h"             // IWYU pragma: export
#include "mallow/executor.h"           // IWYU pragma: export
#include "mallow/ids.h"                // IWYU pragma: export
#include "mallow/instruction_level.h"  // IWYU pragma: export
#include "mallow/material.h"           // IWYU pragma: export
#include "mallow/materials.h"          // IWYU pragma: export
#include "mallow/quality.h"            // IWYU pragma: export
#include "mallow/report.h"             // IWYU pragma: export
#include "mallow/saved_state.h"        // IWYU pragma: export
#include "mallow/simulation.h"         // IWYU pragma: export
#include "mallow/solver_config.h"      // IWYU pragma: export
#include "mallow/vec3.h"               // IWYU pragma: export
#include "mallow/version.h"            // IWYU pragma: export

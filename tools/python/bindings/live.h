#pragma once

#include "mallow/collider.h"
#include "mallow/emitter.h"
#include "mallow/material.h"
#include "mallow/scene.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"
#include "structs.h"

namespace mallow::python {

template <>
inline constexpr bool k_live<SolverConfig> = true;
template <>
inline constexpr bool k_live<Material> = true;
template <>
inline constexpr bool k_live<SurfaceConfig> = true;
template <>
inline constexpr bool k_live<RunConfig> = true;
template <>
inline constexpr bool k_live<RenderConfig> = true;

}  // namespace mallow::python

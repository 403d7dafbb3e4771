#pragma once

#include <array>

#include "mallow/appearance.h"
#include "mallow/instruction_level.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"

namespace mallow {

/// Names of the values of a choice, by their numbers.
constexpr std::array<const char*, 2> choices(Formulation) {
  return {"conservative", "printed"};
}
constexpr std::array<const char*, 2> choices(BodyContact) {
  return {"constraint", "pressure"};
}
constexpr std::array<const char*, 2> choices(Arithmetic) {
  return {"exact", "native"};
}
constexpr std::array<const char*, 3> choices(SurfaceKind) {
  return {"blended", "anisotropic", "spheres"};
}
constexpr std::array<const char*, 5> choices(Finish) {
  return {"jelly", "clay", "cream", "gloss", "syrup"};
}
inline std::array<const char*, 3> choices(InstructionLevel) {
  return {name(InstructionLevel::baseline), name(InstructionLevel::v3), name(InstructionLevel::v4)};
}
template <class T>
concept Choice = requires {
  choices(T{});
};

}  // namespace mallow

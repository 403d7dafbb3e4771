#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"
#include "mallow/vec3.h"

namespace mallow::scene_file {

/// The numbers a field takes; those of a vector or of an alpha schedule, component by component.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool above_lowest = false;  ///< `lowest` itself is not allowed
};
inline constexpr Range k_finite{};
inline constexpr Range k_any{};  ///< of words and flags
inline constexpr Range k_positive{.lowest = 0, .above_lowest = true};
inline constexpr Range k_not_negative{.lowest = 0};
constexpr Range between(double lowest, double highest) {
  return {.lowest = lowest, .highest = highest};
}

/// Three whole numbers, those of a lattice.
using Count3 = std::array<int, 3>;

/// Where the value of a field lives; the type says what TOML may hold.
using Target =
    std::variant<bool*, int*, std::optional<int>*, float*, std::optional<float>*, std::optional<double>*,
                 Vec3*, std::optional<Vec3>*, Count3*, std::string*, std::filesystem::path*, AlphaSchedule*,
                 Formulation*, SurfaceKind*, Finish*, std::optional<InstructionLevel>*>;

/// In place of Field::left_out: a scene without the key is refused.
inline constexpr char k_required[] = "required";

/// A key of a scene file, bound to the member of a config that it sets. Reading, range checks, overrides, the
/// printed scene and the description of all keys are driven by tables of these alone.
struct Field {
  const char* name;
  Target target;
  Range range;
  const char* unit;  ///< empty for plain numbers, words and flags
  const char* doc;
  const char* left_out = "";  ///< what holds without the key, where the member's value does not say it

  bool required() const { return left_out == k_required; }
};
using FieldTable = std::vector<Field>;

/// "a number > 0", "3 numbers in [0, 1]", "\"blended\", \"anisotropic\" or \"spheres\"".
std::string allowed(const Field& field);
/// The value as TOML, or an empty string where it is left out.
std::string value_text(const Field& field);
/// Names of the values of a choice, by their numbers.
constexpr std::array<const char*, 2> choices(Formulation) {
  return {"conservative", "printed"};
}
constexpr std::array<const char*, 3> choices(SurfaceKind) {
  return {"blended", "anisotropic", "spheres"};
}
constexpr std::array<const char*, 2> choices(Finish) {
  return {"jelly", "clay"};
}
template <class T>
concept Choice = requires {
  choices(T{});
};

}  // namespace mallow::scene_file

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/allowed.h"
#include "config/field.h"
#include "mallow/appearance.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"
#include "mallow/vec3.h"

namespace mallow::scene_file {

/// Where the value of a field lives; the type says what TOML may hold.
using Target =
    std::variant<bool*, int*, std::optional<int>*, float*, std::optional<float>*, std::optional<double>*,
                 Vec3*, std::optional<Vec3>*, Count3*, std::string*, std::filesystem::path*, Schedule*,
                 std::optional<Schedule>*, std::vector<Vec3>*, BodyContact*, Formulation*, Arithmetic*,
                 SurfaceKind*, Finish*, std::optional<InstructionLevel>*>;

/// A key of a scene file: a setting, bound to the member of a config that it sets. Reading, range checks,
/// overrides, the printed scene and the description of all keys are driven by lists of these alone.
struct BoundField {
  const char* name;
  Target target;
  Range range;
  const char* unit;  ///< empty for plain numbers, words and flags
  const char* doc;
  const char* left_out = "";  ///< what holds without the key, where the member's value does not say it

  bool required() const { return left_out == k_required; }
};
using BoundFields = std::vector<BoundField>;

/// The settings of a config that scenes hold.
template <class Config>
requires requires {
  FieldTable<Config>::k_fields;
}
BoundFields fields(Config& config) {
  BoundFields bound;
  for_fields<Config>([&](const auto& field) {
    if (field.in_scenes())
      bound.push_back(
          {field.name, &(config.*field.member), field.range, field.unit, field.doc, field.left_out});
  });
  return bound;
}

/// "a number > 0", "3 numbers in [0, 1]", "\"blended\", \"anisotropic\" or \"spheres\"".
std::string allowed(const BoundField& field);
/// What the keys of a schedule are: "time" or "temperature".
std::string key_of_schedule(const BoundField& field);
/// The value as TOML, or an empty string where it is left out.
std::string value_text(const BoundField& field);

}  // namespace mallow::scene_file

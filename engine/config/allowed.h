#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "config/choices.h"
#include "config/field.h"
#include "mallow/export.h"
#include "mallow/material.h"
#include "mallow/vec3.h"

namespace mallow {

/// Three whole numbers, those of a lattice.
using Count3 = std::array<int, 3>;

/// " > 0", " in [0, 1]", or nothing where every finite number is allowed.
MALLOW_EXPORT std::string range_text(const Range& range);
/// "\"a\", \"b\" or \"c\"".
MALLOW_EXPORT std::string choice_text(std::span<const char* const> names);

template <class T>
inline constexpr bool k_is_optional = false;
template <class T>
inline constexpr bool k_is_optional<std::optional<T>> = true;

/// What a value of a type may be, in words, for messages and descriptions: "a number > 0", "3 numbers in
/// [0, 1]", "\"jelly\" or \"clay\"".
template <class T>
std::string allowed(const Range& range) {
  const std::string within = range_text(range);
  if constexpr (k_is_optional<T>)
    return allowed<typename T::value_type>(range);
  else if constexpr (std::is_same_v<T, bool>)
    return "true or false";
  else if constexpr (std::is_integral_v<T>)
    return "a whole number" + within;
  else if constexpr (std::is_floating_point_v<T>)
    return within.empty() ? "a finite number" : "a number" + within;
  else if constexpr (std::is_same_v<T, Vec3>)
    return within.empty() ? "3 finite numbers [x, y, z]" : "3 numbers" + within;
  else if constexpr (std::is_same_v<T, Count3>)
    return "3 whole numbers" + within;
  else if constexpr (std::is_same_v<T, Schedule>)
    return "a number" + within + ", or [[time, number], ...] with times that increase and numbers" + within;
  else
    return choice_text(choices(T{}));
}

}  // namespace mallow

#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mallow {

/// The one of the known names that `name` was probably meant to be, or nullptr: a few letters differ, or it
/// is a part of that one alone. Of long lists the first hundred are compared.
const std::string* nearest_name(std::string_view name, std::span<const std::string> known);

/// What to say about a name that is not known: "; did you mean 'support_radius'?" where one of the known
/// names is close to it, else "; known are a, b and c". Empty where nothing is known.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace mallow

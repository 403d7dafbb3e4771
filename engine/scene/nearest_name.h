#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mallow::scene_file {

/// What to say about a name that is not known: "; did you mean 'support_radius'?" where one of the known
/// names is close to it, else "; known are a, b and c". Empty where nothing is known.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace mallow::scene_file

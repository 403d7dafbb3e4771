#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "scene/document.h"

namespace mallow::scene_file {

/// Tables and lists within each other. No scene has more than 6.
inline constexpr std::size_t k_max_nesting = 16;
/// Points of one key: "a.b.c" has two.
inline constexpr std::size_t k_max_key_points = 8;
/// What a document may hold in all: a value takes one of the characters = , . [ { at least, and up to 500
/// bytes of memory.
inline constexpr std::size_t k_max_values = 1'000'000;

struct DocumentFault {
  Place place;
  std::string message;
};

/// The first thing in a text that a TOML parser must not get to see, if there is one: what goes beyond the
/// limits above, or a character beyond ASCII outside of comments and of strings of one line that stand behind
/// white space, a comma or nothing.
///
/// toml++ 3.3 limits the nesting of values but not that of keys ("a.a.a.a = 1"), and goes into all of it by
/// recursion; its test for white space is undefined for most characters beyond ASCII, which no scene needs
/// there.
std::optional<DocumentFault> find_fault(std::string_view text);

}  // namespace mallow::scene_file

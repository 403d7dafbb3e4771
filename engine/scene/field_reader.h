#pragma once

#include <span>
#include <string>

#include "scene/bound_field.h"
#include "scene/document.h"

namespace mallow::scene_file {

/// Sets each field that `table` gives. Reports keys that are neither fields nor in `also`, keys that are
/// required and missing, and values of the wrong type or out of range; those fields keep the value they had.
/// path: how a user would write the table ("body[2].box"), empty for the root.
void read_fields(const Node& table, const std::string& path, const BoundFields& fields,
                 std::span<const std::string> also, Problems& problems);

/// "path.key", or the key alone at the root.
std::string join_path(const std::string& path, const std::string& key);
/// "body[2]".
std::string element_path(const std::string& path, std::size_t index);
/// "\"abc\" (a string) is not allowed: a number > 0", the one form of every complaint about a value.
std::string not_allowed(const std::string& given, const std::string& allowed);

}  // namespace mallow::scene_file

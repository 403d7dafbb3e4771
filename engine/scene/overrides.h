#pragma once

#include <string>

#include "scene/document.h"

namespace mallow::scene_file {

/// Puts "section.key=value" into a document. Elements of lists are named by number, or by their name where
/// they have one: "material[0].alpha=0.5", "material.paste.alpha=0.5". Where paste is no material of the
/// scene but one that scenes know by name, the scene gets its own copy of it. The value is TOML; what is none
/// stands for a string, so that words need no quotes. What cannot be done is a problem of the override;
/// whether the key exists and the value is allowed shows when the document is read.
void apply_override(Node& root, const std::string& override_text, Problems& problems);

}  // namespace mallow::scene_file

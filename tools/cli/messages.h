#pragma once

#include <span>
#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow::cli {

/// Says on stderr what is not wrong, but worth to be known. Nothing where the text is empty.
void print_warning(const std::string& warning);
/// The notes of a mesh or a scene that was built.
void print_notes(std::span<const std::string> notes);
/// What of a scene is hardly meant.
void print_warnings(const Scene& scene, const SimulationInfo& info);

}  // namespace mallow::cli

#pragma once

#include "scene/bound_field.h"

namespace mallow::view {

/// A setting as something to turn: a slider with its unit over its range, a box, a choice; its doc and range
/// come up beside the mouse. waits: a change has to wait until the scene is built anew, which is said.
/// Returns whether it was changed.
bool field_widget(const scene_file::BoundField& field, bool waits);

/// Alpha, large.
bool alpha_widget(Schedule& alpha);

}  // namespace mallow::view

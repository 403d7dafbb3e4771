#pragma once

#include "scene/bound_field.h"

namespace mallow::view {

/// A setting as something to turn: a slider with its unit over its range, a box, a choice; its doc and range
/// come up beside the mouse. remark: why a change does not act at once, which is said; null: it does.
/// Returns whether it was changed.
bool field_widget(const scene_file::BoundField& field, const char* remark);

/// Alpha, large.
bool alpha_widget(Schedule& alpha);

}  // namespace mallow::view

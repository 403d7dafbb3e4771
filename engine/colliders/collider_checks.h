#pragma once

#include "core/checks.h"
#include "mallow/collider.h"

namespace mallow {

/// path: what stands before the names of its members.
void check_pose(const std::string& path, const Pose& pose, Checks& checks);
/// Everything in a collider that is out of range.
void check(const Collider& collider, Checks& checks);
/// path: of the pose.
void check_pose(const std::string& path, const Pose& pose, Checks& checks);

}  // namespace mallow

#pragma once

#include "core/checks.h"
#include "mallow/collider.h"

namespace mallow {

/// path: what stands before the names of its members.
void check_pose(const std::string& path, const Pose& pose, Checks& checks);
/// path: of what has the pose and goes through the keyframes.
void check_poses(const std::string& path, const Pose& pose, std::span<const PoseKeyframe> keyframes,
                 Checks& checks);
/// Everything in a collider that is out of range.
void check(const Collider& collider, Checks& checks);

}  // namespace mallow

#pragma once

#include <Eigen/Core>
#include <span>

#include "mallow/collider.h"

namespace mallow {

/// R of a pose: from its frame to the world.
MALLOW_EXPORT Eigen::Matrix3d rotation_of(const Pose& pose);
/// One that is turned about x, then y, then z by these degrees, and then moved.
MALLOW_EXPORT Pose pose_of(const Vec3& translation, const Vec3& degrees);
/// Whether the frame does not stand along the axes of the world, or will not.
bool turns(const Collider& collider);
/// (exp(Δt [ω]) − 1)/Δt, which is [ω] as Δt goes to 0: with it a point of the collider moves in a step to
/// where the turned collider has it. [1/s]
Eigen::Matrix3d mean_spin(const Vec3& angular_velocity, double time_step);

/// Velocities that take one pose to another in some seconds, turning the shorter way round.
struct Twist {
  Vec3 velocity{0, 0, 0};          ///< of the translation [m/s]
  Vec3 angular_velocity{0, 0, 0};  ///< [rad/s]
};
MALLOW_EXPORT Twist twist_between(const Pose& from, const Pose& to, double seconds);

/// Gives those that have keyframes the velocities with which a step that ends at `end` [s] takes them there.
void drive_colliders(double end, double time_step, std::span<Collider> colliders);
/// Poses at the end of a step, `end` [s].
void move_colliders(double end, double time_step, std::span<Collider> colliders);
/// Largest speed of the pose's translation: from one keyframe to the next, or `velocity`. [m/s]
double greatest_speed(const Collider& collider);

}  // namespace mallow

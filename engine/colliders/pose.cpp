#include "colliders/pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mallow {
namespace {

Eigen::Quaterniond quaternion(const Pose& pose) {
  return Eigen::Quaterniond(pose.rotation).normalized();
}

/// exp([v])
Eigen::Quaterniond exponential(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

/// The rotation vector that turns one pose to the other, the shorter way round; 0 where they are turned
/// alike.
Eigen::Vector3d turn_between(const Pose& from, const Pose& to) {
  if (from.rotation == to.rotation) return {0, 0, 0};
  Eigen::Quaterniond turn = quaternion(to) * quaternion(from).conjugate();
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  if (sine == 0) return {0, 0, 0};
  return 2 * std::atan2(sine, turn.w()) / sine * turn.vec();
}

bool stands_turned(const Pose& pose) {
  return pose.rotation.head<3>() != Eigen::Vector3d(0, 0, 0);
}

}  // namespace

Eigen::Matrix3d rotation_of(const Pose& pose) {
  return stands_turned(pose) ? quaternion(pose).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

Pose pose_of(const Vec3& translation, const Vec3& degrees) {
  const Eigen::Vector3d angle = degrees.cast<double>() * (std::numbers::pi / 180);
  const Eigen::AngleAxisd about_x(angle.x(), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd about_y(angle.y(), Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd about_z(angle.z(), Eigen::Vector3d::UnitZ());
  return {translation.cast<double>(), (about_z * about_y * about_x).coeffs()};
}

bool turns(const Collider& collider) {
  return stands_turned(collider.pose) || collider.angular_velocity != Vec3(0, 0, 0);
}

Eigen::Matrix3d mean_spin(const Vec3& angular_velocity, double time_step) {
  // 1 - cos cancels for small angles: exp(A) - 1 = A (sin a)/a + A² 2 sin²(a/2)/a².
  const Eigen::Vector3d w = angular_velocity.cast<double>();
  const double rate = w.norm(), angle = time_step * rate;
  if (angle == 0) return Eigen::Matrix3d::Zero();
  Eigen::Matrix3d cross;
  cross << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  const double half = std::sin(angle / 2) / angle;
  return std::sin(angle) / angle * cross + 2 * time_step * half * half * (cross * cross);
}

Pose pose_after(const Collider& collider, double seconds) {
  Pose pose = collider.pose;
  pose.translation += seconds * collider.velocity.cast<double>();
  if (collider.angular_velocity != Vec3(0, 0, 0))
    pose.rotation =
        (exponential(seconds * collider.angular_velocity.cast<double>()) * quaternion(pose)).coeffs();
  return pose;
}

Aabb placed(const Aabb& box, const Pose& pose) {
  if (!stands_turned(pose)) {
    const Vec3 by = pose.translation.cast<float>();
    return {box.min + by, box.max + by};
  }
  const Eigen::Matrix3d rotation = rotation_of(pose);
  const Eigen::Vector3d min = box.min.cast<double>(), max = box.max.cast<double>();
  const Eigen::Vector3d middle = pose.translation + rotation * (0.5 * (min + max));
  const Eigen::Vector3d half = rotation.cwiseAbs() * (0.5 * (max - min));
  return {(middle - half).cast<float>(), (middle + half).cast<float>()};
}

Pose pose_at(std::span<const PoseKeyframe> keyframes, double time) {
  const auto next = std::upper_bound(keyframes.begin(), keyframes.end(), time,
                                     [](double t, const PoseKeyframe& key) { return t < key.time; });
  if (next == keyframes.begin()) return keyframes.front().pose;
  if (next == keyframes.end()) return keyframes.back().pose;
  const PoseKeyframe &from = *(next - 1), &to = *next;
  const double share = (time - from.time) / (to.time - from.time);
  Pose pose;
  pose.translation = from.pose.translation + share * (to.pose.translation - from.pose.translation);
  pose.rotation = (exponential(share * turn_between(from.pose, to.pose)) * quaternion(from.pose)).coeffs();
  return pose;
}

Twist twist_between(const Pose& from, const Pose& to, double seconds) {
  return {((to.translation - from.translation) / seconds).cast<float>(),
          (turn_between(from, to) / seconds).cast<float>()};
}

void drive_colliders(double end, double time_step, std::span<Collider> colliders) {
  for (Collider& collider : colliders) {
    if (collider.keyframes.empty()) continue;
    const Twist twist = twist_between(collider.pose, pose_at(collider.keyframes, end), time_step);
    collider.velocity = twist.velocity;
    collider.angular_velocity = twist.angular_velocity;
  }
}

void move_colliders(double end, double time_step, std::span<Collider> colliders) {
  for (Collider& collider : colliders)
    collider.pose =
        collider.keyframes.empty() ? pose_after(collider, time_step) : pose_at(collider.keyframes, end);
}

double greatest_speed(const Collider& collider) {
  double speed = collider.velocity.cast<double>().norm();
  for (std::size_t k = 1; k < collider.keyframes.size(); ++k) {
    const PoseKeyframe &from = collider.keyframes[k - 1], &to = collider.keyframes[k];
    speed = std::max(speed, (to.pose.translation - from.pose.translation).norm() / (to.time - from.time));
  }
  return speed;
}

}  // namespace mallow

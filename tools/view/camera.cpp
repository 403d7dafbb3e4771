#include "view/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mallow::view {
namespace {

constexpr float k_pi = std::numbers::pi_v<float>;
constexpr float k_turn = 0.006f;            ///< [rad/pixel]
constexpr float k_zoom = 0.88f;             ///< of the distance, a click
constexpr float k_steepest = 0.49f * k_pi;  ///< the view has no up at the poles

}  // namespace

OrbitCamera::OrbitCamera(const render::Camera& camera, const Aabb& bounds)
    : target_(camera.target), field_of_view_(camera.field_of_view) {
  const Vec3 back = camera.eye - camera.target;
  distance_ = std::max(back.norm(), 1e-6f);
  azimuth_ = std::atan2(back.y(), back.x());
  elevation_ = std::clamp(std::asin(std::clamp(back.z() / distance_, -1.0f, 1.0f)), -k_steepest, k_steepest);
  reach_ = std::max(0.5f * (bounds.max - bounds.min).norm(), 1e-6f);
}

void OrbitCamera::turn(float right, float down) {
  azimuth_ -= k_turn * right;
  elevation_ = std::clamp(elevation_ + k_turn * down, -k_steepest, k_steepest);
}

void OrbitCamera::pan(float right, float down) {
  target_ += 2 * view_size() * (down * up() - right * this->right());
}

void OrbitCamera::zoom(float clicks) {
  distance_ = std::clamp(distance_ * std::pow(k_zoom, clicks), 0.02f * reach_, 60 * reach_);
}

Vec3 OrbitCamera::forward() const {
  return -Vec3(std::cos(elevation_) * std::cos(azimuth_), std::cos(elevation_) * std::sin(azimuth_),
               std::sin(elevation_));
}
Vec3 OrbitCamera::right() const {
  return {-std::sin(azimuth_), std::cos(azimuth_), 0};
}
Vec3 OrbitCamera::up() const {
  return right().cross(forward());
}
Vec3 OrbitCamera::eye() const {
  return target_ - distance_ * forward();
}
float OrbitCamera::half_height() const {
  return std::tan(field_of_view_ * k_pi / 360);
}
float OrbitCamera::view_size() const {
  return distance_ * half_height();
}

Ray OrbitCamera::ray(float x, float y) const {
  const Vec3 direction = forward() + half_height() * (x * aspect_ * right() + y * up());
  return {eye(), direction.normalized()};
}

render::Camera OrbitCamera::as_render_camera() const {
  return {.eye = eye(), .target = target_, .up = Vec3::UnitZ(), .field_of_view = field_of_view_};
}

Eigen::Matrix4f OrbitCamera::view() const {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.block<1, 3>(0, 0) = right().transpose();
  matrix.block<1, 3>(1, 0) = up().transpose();
  matrix.block<1, 3>(2, 0) = -forward().transpose();
  matrix.block<3, 1>(0, 3) = -matrix.block<3, 3>(0, 0) * eye();
  return matrix;
}

Eigen::Matrix4f OrbitCamera::projection() const {
  const float far = distance_ + 40 * reach_;
  const float near = std::max(1e-3f * far, 0.02f * distance_);
  const float scale = 1 / half_height();
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Zero();
  matrix(0, 0) = scale / aspect_;
  matrix(1, 1) = scale;
  matrix(2, 2) = (far + near) / (near - far);
  matrix(2, 3) = 2 * far * near / (near - far);
  matrix(3, 2) = -1;
  return matrix;
}

Eigen::Matrix4f OrbitCamera::projection_view() const {
  return projection() * view();
}

}  // namespace mallow::view

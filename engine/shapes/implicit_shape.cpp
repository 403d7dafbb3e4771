#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "mallow/body.h"
#include "shapes/primitives.h"

namespace mallow {
namespace {

struct NamedShape {
  const char* name;
  ImplicitShape (*make)();
};
constexpr std::array k_shapes{NamedShape{"moai", moai_shape}};

constexpr auto k_names = [] {
  std::array<const char*, k_shapes.size()> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = k_shapes[i].name;
  return names;
}();

Eigen::Matrix3f turn(const Vec3& degrees) {
  const Vec3 angle = degrees * (std::numbers::pi_v<float> / 180.0f);
  const Eigen::AngleAxisf about_x(angle.x(), Vec3::UnitX());
  const Eigen::AngleAxisf about_y(angle.y(), Vec3::UnitY());
  const Eigen::AngleAxisf about_z(angle.z(), Vec3::UnitZ());
  return (about_z * about_y * about_x).toRotationMatrix();
}

}  // namespace

ImplicitShape sphere_shape(const Vec3& center, float radius) {
  Checks checks;
  checks.vector("center", center);
  check_value("radius", radius, k_positive, checks);
  checks.finish();
  return {[=](const Vec3& x) { return sphere_distance(x, center, radius); },
          {center - Vec3::Constant(radius), center + Vec3::Constant(radius)},
          4.0 / 3.0 * std::numbers::pi * std::pow(static_cast<double>(radius), 3)};
}

std::span<const char* const> implicit_shape_names() {
  return k_names;
}

ImplicitShape implicit_shape(const std::string& name) {
  std::string known;
  for (const NamedShape& shape : k_shapes) {
    if (name == shape.name) return shape.make();
    known += (known.empty() ? "" : ", ") + std::string(shape.name);
  }
  throw ConfigError("implicit", '"' + name + "\" is not a known shape: one of " + known);
}

ImplicitShape place(const ImplicitShape& shape, const Placement& placement) {
  const Vec3 half = 0.5f * (shape.bounds.max - shape.bounds.min);
  const Vec3 middle = shape.bounds.min + half;
  Checks checks;
  check_fields("", placement, checks);
  checks.finish();

  // The size is measured before the turn: how large a body is must not depend on how it lies.
  const float scale = placement.size ? *placement.size / (2.0f * half.maxCoeff()) : 1.0f;
  const Eigen::Matrix3f rotation = turn(placement.rotate);
  const Vec3 center = placement.center.value_or(middle);
  const Vec3 reach = scale * (rotation.cwiseAbs() * half);
  const Eigen::Matrix3f back = rotation.transpose() / scale;
  return {
      [distance = shape.distance, back, center, middle, scale](const Vec3& x) {
        return scale * distance(back * (x - center) + middle);
      },
      {center - reach, center + reach},
      shape.volume ? std::optional(*shape.volume * std::pow(static_cast<double>(scale), 3)) : std::nullopt,
      shape.notes};
}

}  // namespace mallow

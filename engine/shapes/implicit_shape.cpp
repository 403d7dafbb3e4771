#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "mallow/body.h"
#include "mallow/mesh.h"
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

namespace {

/// x -> scale R (x − middle) + center.
struct PlacedBox {
  float scale;
  Eigen::Matrix3f rotation;
  Vec3 middle, half, center;
};

PlacedBox placed(const Aabb& bounds, const Placement& placement) {
  Checks checks;
  check_fields("", placement, checks);
  checks.finish();
  const Vec3 half = 0.5f * (bounds.max - bounds.min);
  const Vec3 middle = bounds.min + half;
  // The size is measured before the turn: how large a body is must not depend on how it lies.
  return {placement.size ? *placement.size / (2.0f * half.maxCoeff()) : 1.0f, turn(placement.rotate), middle,
          half, placement.center.value_or(middle)};
}

}  // namespace

ImplicitShape place(const ImplicitShape& shape, const Placement& placement) {
  const PlacedBox box = placed(shape.bounds, placement);
  const Vec3 reach = box.scale * (box.rotation.cwiseAbs() * box.half);
  const Eigen::Matrix3f back = box.rotation.transpose() / box.scale;
  return {[distance = shape.distance, back, box](const Vec3& x) {
            return box.scale * distance(back * (x - box.center) + box.middle);
          },
          {box.center - reach, box.center + reach},
          shape.volume ? std::optional(*shape.volume * std::pow(static_cast<double>(box.scale), 3))
                       : std::nullopt,
          shape.notes};
}

Mesh place(Mesh mesh, const Placement& placement, const std::optional<Aabb>& whole) {
  const PlacedBox box = placed(whole.value_or(bounds(mesh)), placement);
  for (Vec3& x : mesh.vertices) x = box.scale * (box.rotation * (x - box.middle)) + box.center;
  for (Vec3& normal : mesh.normals) normal = box.rotation * normal;
  return mesh;
}

}  // namespace mallow

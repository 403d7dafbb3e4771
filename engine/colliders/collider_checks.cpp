#include "colliders/collider_checks.h"

#include "colliders/shapes.h"

namespace mallow {
namespace {

void check_member(const std::string& field, const Vec3& value, ShapeMember::Values, Checks& checks) {
  checks.vector(field, value);
}
void check_member(const std::string& field, float value, ShapeMember::Values values, Checks& checks) {
  if (values == ShapeMember::Values::positive)
    checks.number(field, value, value > 0, "a finite number above 0");
  else
    checks.number(field, value, true, "a finite number");
}
void check_member(const std::string&, bool, ShapeMember::Values, Checks&) {}

template <class Shape>
void check_shape(const Shape& shape, Checks& checks) {
  const std::string path = std::string("collider.") + key_of(shape) + '.';
  const std::optional<ShapeProblem> problem = ShapeTraits<Shape>::problem(shape);
  ShapeTraits<Shape>::visit_members(shape, [&](const auto& value, const ShapeMember& member) {
    check_member(path + member.key, value, member.values, checks);
    if (!problem || std::string_view(problem->key) != member.key) return;
    std::ostringstream text;
    if constexpr (std::is_same_v<decltype(value), const Vec3&>)
      text << '(' << value.transpose() << ')';
    else
      text << value;
    checks.problem(path + member.key, text.str() + " is not allowed: " + problem->allowed);
  });
}

}  // namespace

void check(const Collider& collider, Checks& checks) {
  const Union* shapes = std::get_if<Union>(&collider.shape);
  if (shapes && shapes->parts.empty())
    checks.problem("collider.union", "has no parts: at least one is needed");
  visit_parts(collider, [&](const auto& shape) { check_shape(shape, checks); });
  checks.vector("collider.pose.translation", collider.pose.translation.cast<float>());
  const double length = collider.pose.rotation.norm();
  checks.number("collider.pose.rotation", length, length > 0, "a quaternion of a finite length above 0");
  checks.vector("collider.velocity", collider.velocity);
  checks.vector("collider.angular_velocity", collider.angular_velocity);
  checks.number("collider.restitution", collider.restitution,
                collider.restitution >= 0 && collider.restitution <= 1, "a number in [0, 1]");
  checks.number("collider.friction", collider.friction, collider.friction >= 0,
                "a finite number, 0 or above");
}

}  // namespace mallow

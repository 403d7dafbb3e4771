#include "colliders/collider_checks.h"

#include "colliders/shapes.h"
#include "config/field_checks.h"
#include "config/field_tables.h"

namespace mallow {
namespace {

template <class Shape>
void check_shape(const Shape& shape, Checks& checks) {
  const std::string path = std::string("collider.") + key_of(shape) + '.';
  check_fields(path, shape, checks);
  const std::optional<ShapeProblem> problem = ShapeTraits<Shape>::problem(shape);
  if (!problem) return;
  bool is_field = false;
  for_fields<Shape>([&](const auto& field) {
    if (std::string_view(problem->key) != field.name) return;
    is_field = true;
    const auto& value = shape.*field.member;
    std::ostringstream text;
    if constexpr (std::is_same_v<decltype(value), const Vec3&>)
      text << '(' << value.transpose() << ')';
    else
      text << value;
    checks.problem(path + field.name, text.str() + " is not allowed: " + problem->allowed);
  });
  if (!is_field) checks.problem(path + problem->key, std::string("must be ") + problem->allowed);
}

}  // namespace

void check_pose(const std::string& path, const Pose& pose, Checks& checks) {
  checks.vector(path + ".translation", pose.translation.cast<float>());
  const double length = pose.rotation.norm();
  checks.number(path + ".rotation", length, length > 0, "a quaternion of a finite length above 0");
}

void check_poses(const std::string& path, const Pose& pose, std::span<const PoseKeyframe> keyframes,
                 Checks& checks) {
  check_pose(path + ".pose", pose, checks);
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const std::string key = path + ".keyframes[" + std::to_string(k) + ']';
    checks.number(key + ".time", keyframes[k].time, k == 0 || keyframes[k].time > keyframes[k - 1].time,
                  "a time after that of the keyframe before");
    check_pose(key + ".pose", keyframes[k].pose, checks);
  }
}

void check(const Collider& collider, Checks& checks) {
  const Union* shapes = std::get_if<Union>(&collider.shape);
  if (shapes && shapes->parts.empty())
    checks.problem("collider.union", "has no parts: at least one is needed");
  visit_parts(collider, [&](const auto& shape) { check_shape(shape, checks); });
  check_fields("collider.", collider, checks);
  check_poses("collider", collider.pose, collider.keyframes, checks);
}

}  // namespace mallow

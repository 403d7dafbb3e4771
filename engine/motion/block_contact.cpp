#include "motion/block_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Distances here and those of `nearest` are rounded differently, by a few 1e-7 of the coordinates.
constexpr float k_rounding = 1e-5f;
/// Parts of a union that are remembered as near; where more are, contact asks the whole union.
constexpr std::size_t k_near_parts = 32;

Obstacle obstacle(const Plane& plane) {
  const float length = plane.normal.stableNorm();
  const Vec3 normal = plane.normal / length;
  return {Obstacle::plane, false, {normal[0], normal[1], normal[2]}, {plane.offset / length, 0, 0}};
}
Obstacle obstacle(const Sphere& sphere) {
  const Vec3& center = sphere.center;
  return {Obstacle::sphere, sphere.inside, {center[0], center[1], center[2]}, {sphere.radius, 0, 0}};
}
Obstacle obstacle(const Box& box) {
  return {
      Obstacle::box, box.inside, {box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
}

/// No point of the bounds is nearer to the obstacle, but for rounding.
float least_distance(const Obstacle& o, const BlockBounds& bounds) {
  const Vec3 a(o.a), b(o.b), min(bounds.min), max(bounds.max);
  switch (o.kind) {
    case Obstacle::plane:
      return a.cwiseProduct(min).cwiseMin(a.cwiseProduct(max)).sum() - b[0];
    case Obstacle::sphere:
      if (o.inside) return b[0] - (a - min).cwiseMax(max - a).norm();
      return (min - a).cwiseMax(a - max).cwiseMax(0.0f).norm() - b[0];
    case Obstacle::box:
      if (o.inside) return (min - a).cwiseMin(b - max).minCoeff();
      return (min - b).cwiseMax(a - max).cwiseMax(0.0f).norm();
  }
  return 0;
}

float largest_coordinate(const Obstacle& o, const BlockBounds& bounds) {
  float largest = 0;
  for (const float* const corner : {o.a, o.b, bounds.min, bounds.max})
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(corner[k]));
  return largest;
}

/// Which rows of a block, and which parts of a collider, may touch.
class NearRows {
 public:
  NearRows(const ContactBlock& block, const Collider& collider, const ContactStep& step,
           const MotionKernels& kernels, const VectorColumn& velocity)
      : block_(block), collider_(collider), step_(step), kernels_(kernels), velocity_(velocity) {
    greatest_reach_ = step.contact_offset +
                      step.time_step * (std::sqrt(block.bounds.squared_speed) + collider.velocity.norm());
    if (const Union* const shapes = std::get_if<Union>(&collider.shape)) {
      for (const Primitive& part : shapes->parts)
        if (std::visit([&](const auto& shape) { return mark(shape); }, part)) remember(part);
    } else {
      std::visit([&](const auto& shape) { mark(shape); }, collider.shape);
    }
  }
  bool any() const { return any_; }
  bool contains(std::size_t row) const { return flags_[row - block_.begin] != 0; }

  SurfacePoint nearest_surface(const Vec3& x) const {
    if (!std::holds_alternative<Union>(collider_.shape) || count_ > k_near_parts)
      return std::visit([&](const auto& shape) { return nearest(shape, x); }, collider_.shape);
    SurfacePoint best{std::numeric_limits<float>::infinity(), Vec3::UnitZ()};
    for (std::size_t k = 0; k < count_; ++k) {
      const SurfacePoint point = std::visit([&](const auto& shape) { return nearest(shape, x); }, *parts_[k]);
      if (point.distance < best.distance) best = point;
    }
    return best;
  }

 private:
  bool mark(const Union&) { return false; }
  template <class Shape>
  bool mark(const Shape& shape) {
    const Obstacle o = obstacle(shape);
    const float slack = k_rounding * (largest_coordinate(o, block_.bounds) + greatest_reach_);
    // What is not a number is not far, either.
    if (least_distance(o, block_.bounds) > greatest_reach_ + slack) return false;
    if (!any_) {
      any_ = true;
      std::fill_n(flags_.begin(), block_.end - block_.begin, std::uint8_t{0});
      kernels_.reach(raw(velocity_), collider_.velocity.data(), step_.time_step, step_.contact_offset,
                     block_.begin, block_.end, reach_.data());
    }
    kernels_.mark(o, raw(block_.position), slack, block_.begin, block_.end, reach_.data(), flags_.data());
    return true;
  }
  void remember(const Primitive& part) {
    if (count_ < k_near_parts) parts_[count_] = &part;
    ++count_;
  }

  const ContactBlock& block_;
  const Collider& collider_;
  const ContactStep& step_;
  const MotionKernels& kernels_;
  const VectorColumn& velocity_;
  float greatest_reach_;
  bool any_ = false;
  std::size_t count_ = 0;
  std::array<const Primitive*, k_near_parts> parts_;
  std::array<std::uint8_t, k_block> flags_;
  alignas(64) std::array<float, k_block> reach_;
};

}  // namespace

void resolve_contacts(const ContactBlock& rows, std::span<const Collider> colliders, const ContactStep& step,
                      const MotionKernels& kernels, VectorColumn& velocity) {
  ContactBlock block = rows;
  for (const Collider& collider : colliders) {
    const NearRows near(block, collider, step, kernels, velocity);
    if (!near.any()) continue;
    for (std::size_t i = block.begin; i < block.end; ++i) {
      if (!near.contains(i) || (block.pin && block.pin[i] != 0)) continue;
      const SurfacePoint surface = near.nearest_surface(block.position.get(i));
      const Vec3 v = resolve_contact(collider, surface, step, velocity.get(i));
      velocity.set(i, v);
      block.bounds.squared_speed = std::max(block.bounds.squared_speed, v.squaredNorm());
    }
  }
}

}  // namespace mallow
